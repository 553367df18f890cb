// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/compare.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace pm::host {
namespace {

using Beauty = std::array<const Channel*, 3>;
constexpr std::array<const char*, 3> kBeautyNames{"R", "G", "B"};

Beauty beautyOf(const Picture& picture, const char* which) {
    Beauty beauty{};
    for (std::size_t c = 0; c < 3; ++c) {
        beauty[c] = picture.find(kBeautyNames[c]);
        if (beauty[c] != nullptr) continue;
        throw HostError(ExitCode::kBadInput,
                        fmt::format("the {} has no channel {}; R, G and B are compared", which,
                                    kBeautyNames[c]));
    }
    return beauty;
}

// Calls use(reference value, picture value) for every value of the picture's data window.
template <typename Use>
void forEachPair(const Picture& reference, const Picture& picture, const Use& use) {
    const Beauty references = beautyOf(reference, "reference");
    const Beauty values = beautyOf(picture, "picture");
    const PixelRect& r = reference.dataWindow;
    const PixelRect& p = picture.dataWindow;
    const auto at = [](const PixelRect& window, std::int32_t x, std::int32_t y) {
        return static_cast<std::size_t>(y - window.y0) * static_cast<std::size_t>(window.width()) +
               static_cast<std::size_t>(x - window.x0);
    };
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::int32_t y = p.y0; y < p.y1; ++y) {
            for (std::int32_t x = p.x0; x < p.x1; ++x) {
                use(references[c]->values[at(r, x, y)], values[c]->values[at(p, x, y)]);
            }
        }
    }
}

}  // namespace

void checkSameSize(std::int32_t referenceWidth, std::int32_t referenceHeight, std::int32_t width,
                   std::int32_t height) {
    if (referenceWidth == width && referenceHeight == height) return;
    throw HostError(ExitCode::kBadInput,
                    fmt::format("the reference is {}x{}, the picture {}x{}; they must be the same "
                                "(--size)",
                                referenceWidth, referenceHeight, width, height));
}

void checkWindows(const Picture& reference, std::int32_t width, std::int32_t height,
                  const PixelRect& dataWindow) {
    checkSameSize(reference.width, reference.height, width, height);
    const PixelRect& r = reference.dataWindow;
    const PixelRect& p = dataWindow;
    if (p.empty() || p.x0 < r.x0 || p.y0 < r.y0 || p.x1 > r.x1 || p.y1 > r.y1) {
        throw HostError(ExitCode::kBadInput,
                        fmt::format("the picture's data window {},{},{},{} must lie inside the "
                                    "reference's {},{},{},{} (--crop)",
                                    p.x0, p.y0, p.x1, p.y1, r.x0, r.y0, r.x1, r.y1));
    }
}

double errorOffset(std::int32_t errorScaleStops) {
    return std::ldexp(0.01, -2 * errorScaleStops);
}

std::optional<std::int32_t> errorScaleOf(const Picture& picture) {
    constexpr std::int32_t kMost = 40;
    const auto found = picture.attributes.find("pm:errorScale");
    if (found == picture.attributes.end()) return std::nullopt;
    const auto* const stops = std::get_if<std::int32_t>(&found->second);
    if (stops == nullptr || *stops < -kMost || *stops > kMost) return std::nullopt;
    return *stops;
}

std::string errorScaleText(std::int32_t errorScaleStops) {
    if (errorScaleStops == 0) return {};
    return fmt::format(" at an error scale of {} stops", errorScaleStops);
}

ErrorReport compareRelMse(const Picture& reference, const Picture& picture, double offset) {
    checkWindows(reference, picture.width, picture.height, picture.dataWindow);
    ErrorReport report;
    forEachPair(reference, picture, [&](float r, float x) {
        report.badInReference += std::isfinite(r) ? 0 : 1;
        report.badInPicture += std::isfinite(x) ? 0 : 1;
    });
    if (report.badInReference > 0 || report.badInPicture > 0) return report;
    double sum = 0.0;
    forEachPair(reference, picture, [&](float rf, float xf) {
        const double r = rf, x = xf;
        sum += (x - r) * (x - r) / (r * r + offset);
    });
    report.relMse = sum / (3.0 * static_cast<double>(picture.dataWindow.area()));
    return report;
}

}  // namespace pm::host
