// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/colour/exposure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace pm::host {
namespace {

constexpr double kMiddleGrey = 0.18;
constexpr double kMostHighlight = 2.0;
constexpr double kHighlightShare = 0.02;
// Of the highlights: darker than this counts as this, or a few black pixels would rule a mean of
// logarithms.
constexpr double kDarkest = 1e-4;
constexpr double kLeastMeteredShare = 0.1;
// What the largest exposure makes a hundredth of white.
const double kLeastShown = 0.01 * std::exp2(-kMostExposureStops);

struct Seen {
    // Luminance of each covered pixel, but for those of surfaces that reflect next to nothing: no
    // exposure that suits others shows these. Where there are no others, those that do reflect.
    std::vector<double> surfaces, lamps;
    double black{};  // how many pixels are of surfaces that reflect nothing in any light
    double all{};    // covered, but for lamps
};

Seen seen(const Picture& picture, const std::array<double, 3>& weights) {
    constexpr std::array<const char*, 3> kBeauty{"R", "G", "B"};
    constexpr std::array<const char*, 3> kEmission{"emission.R", "emission.G", "emission.B"};
    constexpr std::array<const char*, 3> kAlbedo{"albedo.R", "albedo.G", "albedo.B"};
    constexpr double kBlack = 1e-4;
    const bool knowsAlbedo = picture.find(kAlbedo[0]) != nullptr;
    const auto luminance = [&](const std::array<const char*, 3>& names, std::size_t i) {
        double sum = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const Channel* channel = picture.find(names[c]);
            if (channel != nullptr) sum += weights[c] * static_cast<double>(channel->values[i]);
        }
        return std::isfinite(sum) ? std::max(sum, 0.0) : 0.0;
    };
    Seen result;
    std::vector<double> dim;
    const Channel* alpha = picture.find("A");
    if (alpha == nullptr) return result;
    for (std::size_t i = 0; i < alpha->values.size(); ++i) {
        if (!(alpha->values[i] > 0.0f)) continue;
        const bool isLamp = luminance(kEmission, i) > 0;
        const double albedo = knowsAlbedo ? luminance(kAlbedo, i) : 1;
        const bool isBlack = !isLamp && !(albedo > 0);
        result.all += isLamp ? 0 : 1;
        result.black += isBlack ? 1 : 0;
        if (isBlack) continue;
        (isLamp            ? result.lamps
         : albedo < kBlack ? dim
                           : result.surfaces)
            .push_back(luminance(kBeauty, i));
    }
    if (result.surfaces.empty()) result.surfaces = std::move(dim);
    return result;
}

}  // namespace

std::string exposureText(const Exposure& exposure) {
    return fmt::format("{:.6g}{}", exposure.stops,
                       exposure.from == Exposure::From::kMeasured ? " (auto)" : "");
}

double measuredExposureStops(const Picture& picture, const std::array<double, 3>& luminance) {
    Seen all = seen(picture, luminance);
    std::vector<double>& metered = all.surfaces;
    const auto covered = static_cast<double>(all.surfaces.size() + all.lamps.size());
    if (static_cast<double>(metered.size()) < kLeastMeteredShare * covered)
        metered.insert(metered.end(), all.lamps.begin(), all.lamps.end());
    if (metered.empty()) return 0;
    std::ranges::sort(metered);
    const auto beyond =
        static_cast<std::size_t>(kHighlightShare * static_cast<double>(metered.size()));
    double highlight = metered[metered.size() - 1 - beyond];
    if (!(highlight > 0)) highlight = metered.back();
    if (!(highlight > 0)) return 0;
    double sum = 0;
    for (const double value : metered) sum += std::log2(std::max(value, kDarkest * highlight));
    const double mean = sum / static_cast<double>(metered.size());
    const double stops =
        std::min(std::log2(kMiddleGrey) - mean, std::log2(kMostHighlight / highlight));
    constexpr double kSteps = 100;
    // Adding 0 makes -0 a 0.
    return std::round(std::clamp(stops, -kMostExposureStops, kMostExposureStops) * kSteps) /
               kSteps +
           0.0;
}

double darkShare(const Picture& picture, const std::array<double, 3>& luminance) {
    constexpr double kNearlyBlack = 0.00243;  // code 8
    const Seen all = seen(picture, luminance);
    if (all.surfaces.empty()) return 0;
    const double least = kNearlyBlack * std::exp2(-measuredExposureStops(picture, luminance));
    const auto dark =
        std::ranges::count_if(all.surfaces, [least](double value) { return value < least; });
    return static_cast<double>(dark) / static_cast<double>(all.surfaces.size());
}

double litShare(const Picture& picture, const std::array<double, 3>& luminance) {
    const Seen all = seen(picture, luminance);
    if (all.surfaces.empty()) return 1;
    const auto lit =
        std::ranges::count_if(all.surfaces, [](double value) { return value >= kLeastShown; });
    return static_cast<double>(lit) / static_cast<double>(all.surfaces.size());
}

double blackShare(const Picture& picture, const std::array<double, 3>& luminance) {
    const Seen all = seen(picture, luminance);
    return all.all > 0 ? all.black / all.all : 0;
}

}  // namespace pm::host
