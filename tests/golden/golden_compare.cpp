// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/golden/golden_compare.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "tests/colour/picture_compare.h"
#include "tests/scene/picture_measures.h"

namespace pm::host::test {
namespace {

constexpr std::array<const char*, 3> kColours{"R", "G", "B"};
constexpr std::array<const char*, 3> kErrors{"stderr.X", "stderr.Y", "stderr.Z"};

struct Estimate {
    double mean{}, variance{};
};

std::vector<PixelRect> regionsOf(const PixelRect& window) {
    constexpr std::int32_t kSide = 8;
    std::vector<PixelRect> regions{window};
    for (std::int32_t y = window.y0; y < window.y1; y += kSide) {
        for (std::int32_t x = window.x0; x < window.x1; x += kSide) {
            regions.push_back(
                {x, y, std::min(x + kSide, window.x1), std::min(y + kSide, window.y1)});
        }
    }
    return regions;
}

// Calls use(index of the pixel in a channel).
template <typename Use>
void forEachPixel(const PixelRect& region, const PixelRect& window, const Use& use) {
    for (std::int32_t y = region.y0; y < region.y1; ++y) {
        for (std::int32_t x = region.x0; x < region.x1; ++x) {
            use(static_cast<std::size_t>((y - window.y0) * window.width() + x - window.x0));
        }
    }
}

double regionMean(const Picture& picture, const PixelRect& region, std::size_t colour) {
    const Channel* channel = picture.find(kColours[colour]);
    double sum = 0.0;
    forEachPixel(region, picture.dataWindow,
                 [&](std::size_t i) { sum += static_cast<double>(channel->values[i]); });
    return sum / static_cast<double>(region.area());
}

// Pixels of a path tracer are independent, so their variances add up.
Estimate ofGolden(const Picture& golden, const PixelRect& region, std::size_t colour) {
    const Channel* errors = golden.find(kErrors[colour]);
    double variance = 0.0;
    forEachPixel(region, golden.dataWindow, [&](std::size_t i) {
        const auto error = static_cast<double>(errors->values[i]);
        variance += error * error;
    });
    const auto area = static_cast<double>(region.area());
    return {regionMean(golden, region, colour), variance / (area * area)};
}

Estimate ofRuns(const std::vector<Picture>& runs, const PixelRect& region, std::size_t colour) {
    const auto count = static_cast<double>(runs.size());
    double sum = 0.0, squares = 0.0;
    for (const Picture& run : runs) sum += regionMean(run, region, colour);
    for (const Picture& run : runs) {
        const double off = regionMean(run, region, colour) - sum / count;
        squares += off * off;
    }
    return {sum / count, squares / (count * (count - 1.0))};
}

struct Worst {
    double excess{-1.0};  // over the bias allowed, in standard errors
    std::string text{"no region"};
};

Worst worstRegion(const Picture& golden, const std::vector<Picture>& runs, double bias) {
    Worst worst;
    for (const PixelRect& region : regionsOf(golden.dataWindow)) {
        for (std::size_t c = 0; c < 3; ++c) {
            const Estimate g = ofGolden(golden, region, c), r = ofRuns(runs, region, c);
            const double off = std::fabs(r.mean - g.mean) - bias * std::fabs(g.mean);
            const double error = std::sqrt(g.variance + r.variance);
            const double excess =
                off <= 0.0 ? 0.0 : (error > 0.0 ? off / error : std::numeric_limits<double>::max());
            if (excess <= worst.excess) continue;
            worst = {excess,
                     fmt::format("{} of {},{},{},{} is {:.6g} instead of {:.6g} +- {:.2g}, {:.1f} "
                                 "standard errors beyond a bias of {} %",
                                 kColours[c], region.x0, region.y0, region.x1, region.y1, r.mean,
                                 g.mean, error, excess, 100.0 * bias)};
        }
    }
    return worst;
}

}  // namespace

testing::AssertionResult agreesWithGolden(const Picture& golden, const std::vector<Picture>& runs,
                                          const GoldenBounds& bounds) {
    for (const Picture& run : runs) {
        if (auto finite = allFinite(run); !finite) return finite;
    }
    if (runs.size() < 2) return testing::AssertionFailure() << "two runs are needed at least";
    // Form only: any value will do here.
    PictureTolerance form;
    form.absolute = std::numeric_limits<double>::max();
    form.freeAttributes = bounds.freeAttributes;
    Picture first = runs[0];
    // A later version may write attributes that the golden picture's did not.
    std::erase_if(first.attributes, [&](const auto& attribute) {
        return !golden.attributes.contains(attribute.first);
    });
    if (auto same = samePicture(golden, first, form); !same) return same;
    for (const char* name : kErrors) {
        if (golden.find(name) == nullptr) return testing::AssertionFailure() << "no " << name;
    }
    const Worst worst = worstRegion(golden, runs, bounds.bias);
    const bool agrees = worst.excess <= bounds.sigmas;
    return (agrees ? testing::AssertionSuccess() : testing::AssertionFailure()) << worst.text;
}

}  // namespace pm::host::test
