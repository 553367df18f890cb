// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/check/pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "host_shim/pictures/compare.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

constexpr double kRounding = 1e-6;
constexpr double kLeastNoise = 0.05;  // of a pixel's mean
constexpr double kLeastLight = 1e-6;  // at an error scale of 0
constexpr double kMostNoise = 3;      // standard deviations
constexpr std::array<const char*, 3> kColours{"R", "G", "B"};

double medianOf(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

// Of one colour, row by row.
std::vector<double> noiseIn(const Channel& mean, const Channel& deviation,
                            std::span<const float> values, const PixelRect& window, double unit) {
    std::vector<double> noise(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double m = mean.values[i];
        const double least = kLeastNoise * m + kLeastLight * unit;
        const double off = (values[i] - m) / std::max<double>(deviation.values[i], least);
        noise[i] = std::clamp(off, -kMostNoise, kMostNoise);
    }
    const RegionGrid grid(window, kPairSide);
    const auto width = static_cast<std::size_t>(window.width());
    const auto forEachIn = [&](const PixelRect& area, const auto& work) {
        for (std::int32_t y = area.y0; y < area.y1; ++y)
            for (std::int32_t x = area.x0; x < area.x1; ++x)
                work(noise[static_cast<std::size_t>(y - window.y0) * width +
                           static_cast<std::size_t>(x - window.x0)]);
    };
    for (std::int32_t row = 0; row < grid.rows(); ++row)
        for (std::int32_t column = 0; column < grid.columns(); ++column) {
            const PixelRect area = grid.rect(column, row);
            double sum = 0;
            forEachIn(area, [&](double value) { sum += value; });
            const double shared = sum / static_cast<double>(area.area());
            forEachIn(area, [&](double& value) { value -= shared; });
        }
    return noise;
}

}  // namespace

PairSpread pairSpreadOf(const std::vector<double>& kept,
                        const std::vector<std::vector<double>>& twins) {
    if (twins.empty()) throw HostError(ExitCode::kInternal, "pairs are told apart by twins");
    std::vector<double> squares(kept.size()), relative;
    for (std::size_t i = 0; i < kept.size(); ++i) {
        for (const std::vector<double>& twin : twins)
            squares[i] += (twin[i] - kept[i]) * (twin[i] - kept[i]);
        squares[i] /= static_cast<double>(twins.size());
        if (kept[i] != 0) relative.push_back(squares[i] / (kept[i] * kept[i]));
    }
    const double usual = medianOf(std::move(relative));
    PairSpread spread{kept, {}};
    for (std::size_t i = 0; i < kept.size(); ++i) {
        const double square = kept[i] * kept[i];
        spread.variance.push_back((squares[i] + usual * square) / 2 +
                                  kRounding * kRounding * square);
    }
    return spread;
}

RegionFinding furthestOfPair(const PixelRect& window, const PairSpread& spread,
                             const std::vector<double>& means) {
    const RegionGrid grid(window, kPairSide);
    const std::vector<double>& kept = spread.mean;
    RegionFinding found;
    for (std::size_t i = 0; i < means.size(); ++i) {
        const double off = means[i] - kept[i];
        const double z = off == 0 ? 0 : off / std::sqrt(spread.variance[i]);
        if (i != 0 && std::abs(z) <= std::abs(found.z)) continue;
        found = {grid.rectOf(i / 3), static_cast<int>(i % 3), z, kept[i] != 0 ? off / kept[i] : 0};
        if (std::isnan(z)) break;  // nothing is farther off
    }
    return found;
}

double seenByPairs(const PairSpread& spread) {
    const std::vector<double>& kept = spread.mean;
    std::vector<double> changes;
    for (std::size_t i = 0; i < kept.size(); ++i)
        if (kept[i] > 0) changes.push_back(kPairLimit * std::sqrt(spread.variance[i]) / kept[i]);
    return medianOf(std::move(changes));
}

Picture pixelNoiseOf(const std::vector<const Picture*>& pictures) {
    const Picture& first = *pictures.front();
    Picture noise{first.width, first.height, first.dataWindow, {}, {}};
    std::array<Channel, 3> means, deviations;
    const auto count = static_cast<double>(pictures.size());
    for (std::size_t c = 0; c < 3; ++c) {
        means[c] = {std::string("mean.") + kColours[c], false, {}};
        deviations[c] = {std::string("deviation.") + kColours[c], false, {}};
        const std::size_t size = beautyOf(first).values[c].size();
        std::vector<double> sums(size), squares(size);
        for (const Picture* picture : pictures) {
            const std::span<const float> values = beautyOf(*picture).values[c];
            for (std::size_t i = 0; i < size; ++i) sums[i] += values[i];
        }
        for (const Picture* picture : pictures) {
            const std::span<const float> values = beautyOf(*picture).values[c];
            for (std::size_t i = 0; i < size; ++i) {
                const double off = values[i] - sums[i] / count;
                squares[i] += off * off;
            }
        }
        for (std::size_t i = 0; i < size; ++i) {
            means[c].values.push_back(static_cast<float>(sums[i] / count));
            deviations[c].values.push_back(static_cast<float>(std::sqrt(squares[i] / (count - 1))));
        }
    }
    for (auto& channels : {&means, &deviations})
        for (Channel& channel : *channels) noise.channels.push_back(std::move(channel));
    return noise;
}

std::optional<double> noiseCorrelation(const Picture& noise, const Picture& a, const Picture& b) {
    if (!(noise.dataWindow == a.dataWindow) || !(noise.dataWindow == b.dataWindow))
        return std::nullopt;
    double ab = 0, aa = 0, bb = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const Channel* mean = noise.find(std::string("mean.") + kColours[c]);
        const Channel* deviation = noise.find(std::string("deviation.") + kColours[c]);
        if (mean == nullptr || deviation == nullptr) return std::nullopt;
        const auto of = [&](const Picture& picture) {
            return noiseIn(*mean, *deviation, beautyOf(picture).values[c], noise.dataWindow,
                           std::exp2(-errorScaleOf(a).value_or(0)));
        };
        const std::vector<double> inA = of(a), inB = of(b);
        for (std::size_t i = 0; i < inA.size(); ++i) {
            ab += inA[i] * inB[i];
            aa += inA[i] * inA[i];
            bb += inB[i] * inB[i];
        }
    }
    if (!(aa > 0) || !(bb > 0)) return std::nullopt;
    return ab / std::sqrt(aa * bb);
}

}  // namespace pm::host
