// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/scene/picture_measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace pm::host::test {
namespace {

constexpr std::array<char, 3> kColours{'R', 'G', 'B'};
constexpr std::array<const char*, 3> kErrors{"stderr.X", "stderr.Y", "stderr.Z"};

const std::vector<float>& valuesOf(const Picture& picture, const std::string& name) {
    const Channel* channel = picture.find(name);
    if (channel == nullptr) throw std::invalid_argument("the picture has no channel " + name);
    return channel->values;
}

double squared(double value) {
    return value * value;
}

struct PixelError {
    double error{}, predicted{}, picture{}, reference{}, brightest{};
};

std::vector<PixelError> pixelErrors(const Picture& reference, const Picture& picture) {
    std::vector<PixelError> pixels(valuesOf(reference, "R").size());
    for (std::size_t c = 0; c < 3; ++c) {
        const std::string name(1, kColours[c]);
        const auto& r = valuesOf(reference, name);
        const auto& x = valuesOf(picture, name);
        const auto& e = valuesOf(picture, kErrors[c]);
        if (x.size() != r.size()) throw std::invalid_argument("the windows differ");
        for (std::size_t i = 0; i < r.size(); ++i) {
            const double weight = 1.0 / (squared(static_cast<double>(r[i])) + 0.01);
            pixels[i].error +=
                squared(static_cast<double>(x[i]) - static_cast<double>(r[i])) * weight;
            pixels[i].predicted += squared(static_cast<double>(e[i])) * weight;
            pixels[i].picture += static_cast<double>(x[i]);
            pixels[i].reference += static_cast<double>(r[i]);
            pixels[i].brightest = std::max(pixels[i].brightest, static_cast<double>(r[i]));
        }
    }
    return pixels;
}

bool lampNear(const std::vector<PixelError>& pixels, const PixelRect& window, std::int32_t x,
              std::int32_t y) {
    for (std::int32_t j = std::max(y - 2, 0); j < std::min(y + 3, window.height()); ++j) {
        for (std::int32_t i = std::max(x - 2, 0); i < std::min(x + 3, window.width()); ++i) {
            if (pixels[static_cast<std::size_t>(j * window.width() + i)].brightest > 5.0)
                return true;
        }
    }
    return false;
}

double ratioAwayFromLamps(const std::vector<PixelError>& pixels, const PixelRect& window) {
    double sum = 0.0, referenceSum = 0.0;
    for (std::int32_t i = 0; i < window.area(); ++i) {
        if (lampNear(pixels, window, i % window.width(), i / window.width())) continue;
        sum += pixels[static_cast<std::size_t>(i)].picture;
        referenceSum += pixels[static_cast<std::size_t>(i)].reference;
    }
    return sum / referenceSum;
}

}  // namespace

testing::AssertionResult allFinite(const Picture& picture) {
    if (picture.channels.empty()) return testing::AssertionFailure() << "a picture of no channels";
    for (const Channel& channel : picture.channels) {
        const auto bad = std::find_if(channel.values.begin(), channel.values.end(),
                                      [](float value) { return !std::isfinite(value); });
        if (bad == channel.values.end()) continue;
        const auto width = picture.dataWindow.width();
        const auto pixel = bad - channel.values.begin();
        return testing::AssertionFailure()
               << fmt::format("{} is {} at {},{} of the data window", channel.name, *bad,
                              pixel % width, pixel / width);
    }
    return testing::AssertionSuccess();
}

testing::AssertionResult isLit(const Picture& picture, double fraction) {
    std::size_t lit = 0, covered = 0;
    const auto &r = valuesOf(picture, "R"), &g = valuesOf(picture, "G"),
               &b = valuesOf(picture, "B");
    const auto& coverage = valuesOf(picture, "A");
    for (std::size_t i = 0; i < coverage.size(); ++i) {
        covered += coverage[i] > 0.0f ? 1u : 0u;
        lit += coverage[i] > 0.0f && std::max({r[i], g[i], b[i]}) > 1e-6f ? 1u : 0u;
    }
    if (lit > 0 && static_cast<double>(lit) >= fraction * static_cast<double>(covered)) {
        return testing::AssertionSuccess();
    }
    return testing::AssertionFailure()
           << fmt::format("only {} of {} covered pixels have light", lit, covered);
}

Means meansOf(const Picture& picture, const std::string& prefix) {
    Means means{};
    for (std::size_t c = 0; c < 3; ++c) {
        const auto& values = valuesOf(picture, prefix + kColours[c]);
        means[c] =
            std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    }
    return means;
}

Picture halved(const Picture& picture) {
    const PixelRect& window = picture.dataWindow;
    const auto width = static_cast<std::size_t>(window.width()) / 2;
    const auto height = static_cast<std::size_t>(window.height()) / 2;
    Picture half{picture.width / 2, picture.height / 2, {}, {}, picture.attributes};
    half.dataWindow = {window.x0 / 2, window.y0 / 2, window.x1 / 2, window.y1 / 2};
    for (const Channel& channel : picture.channels) {
        Channel& out = half.channels.emplace_back(Channel{channel.name, channel.isColour, {}});
        for (std::size_t i = 0; i < width * height; ++i) {
            const float* at = &channel.values[4 * (i / width) * width + 2 * (i % width)];
            out.values.push_back((at[0] + at[1] + at[2 * width] + at[2 * width + 1]) / 4.0f);
        }
    }
    return half;
}

ReferenceError errorAgainst(const Picture& reference, const Picture& picture, double dropped) {
    std::vector<PixelError> pixels = pixelErrors(reference, picture);
    const double meanRatio = ratioAwayFromLamps(pixels, reference.dataWindow);
    std::sort(pixels.begin(), pixels.end(),
              [](const PixelError& a, const PixelError& b) { return a.error < b.error; });
    const auto count = static_cast<double>(pixels.size());
    pixels.resize(static_cast<std::size_t>(std::floor(count * (1.0 - dropped))));
    double error = 0.0, predicted = 0.0;
    for (const PixelError& pixel : pixels) {
        error += pixel.error;
        predicted += pixel.predicted;
    }
    const double values = 3.0 * static_cast<double>(pixels.size());
    return {error / values, predicted / values, meanRatio};
}

}  // namespace pm::host::test
