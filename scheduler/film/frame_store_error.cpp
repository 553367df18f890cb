// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors

// The frame's error out of the frame store; the method is told at FrameError.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <vector>

#include "scheduler/buckets/fp_environment.h"
#include "scheduler/film/frame_store.h"

namespace pm {
namespace {

// Mean square of the bias over that of the probe. Where light is smooth over a radius, bias goes
// with the radius squared and this is 4; at a crease 5.2; at a sharp edge, whose blur gets narrower
// and no lower, 13.2 for a disc of photons and 14.6 for the kernel of the gather points (integrals
// across it). Which it is, noise doesn't let two radii tell. Midway between the outermost: wrong by
// no more than a factor of 2 whatever the light is like.
constexpr double kBiasPerProbe = 8;
// Light finer than a radius r changes with it: a line's density as 1 / r, a point's as 1 / r^2, so
// a radius narrowed by sqrt(2) finds 1.4 times or twice as much. An even one, its noise aside,
// finds the same.
constexpr double kUnresolvedChange = 0.3;
// A pixel is taken as unlike its neighbours by what is more than so many variances of its mean.
constexpr double kUnlikeVariances = 2;

// A lamp that a pixel sees, in a mirror or through glass too, is no outlier however bright it is
// among what is around: so much of what the pixel has of it is believed, whatever the neighbours.
constexpr double kBelievedEmission = 0.5;

// What stands for the reference in relMSE's denominator. A pixel's own mean would excuse an outlier
// by its own square; its neighbours know neither edges nor textures. So: the middle between the
// neighbours' mean and the own one held within what they span, and of the distance from there to
// the own mean as much of the square as is more than noise.
double standIn(double own, double variance, const Neighbours& neighbours) {
    if (neighbours.count == 0) return own;
    // Not std::clamp, which NaN would have outside of its contract.
    const double held = std::max(neighbours.low, std::min(own, neighbours.high));
    const double like = 0.5 * (held + neighbours.mean);
    const double off = own - like;
    const double square = off * off;
    const double noise = kUnlikeVariances * variance;
    return square > noise ? like + off * (square - noise) / square : like;
}

using Channels = std::array<double, FrameStore::kBeautyChannels>;

// A pixel's means, and what is known of their noise.
struct PixelMeans {
    Channels beauty{}, lamps{};  // lamps: the part of the beauty from lamps that the pixel sees
    Channels halves{};           // variance of the mean, by what the halves differ by
    Channels passes{};           // by what the passes differ by
};

// 1 / (r^2 + offset) of a pixel's channels, r what stands for the reference.
Channels inverseSquares(const PixelMeans& pixel, std::size_t column, const NeighbourRows& rows,
                        double offset) {
    double lampSquare = 0, variance = 0;
    Channels inverses{};
    for (std::size_t i = 0; i < inverses.size(); ++i) {
        const double like = standIn(pixel.beauty[i], pixel.passes[i], rows.around(column, i));
        const double reference = std::max(like, kBelievedEmission * pixel.lamps[i]);
        inverses[i] = 1 / (reference * reference + offset);
        lampSquare += pixel.lamps[i] * pixel.lamps[i];
        variance += pixel.halves[i];
    }
    if (!(lampSquare > 0 && variance > 0)) return inverses;
    // Of the two guesses the one that makes more of the error: each of them knows of errors that
    // the other takes for light.
    const SeldomLight seldom(lampSquare, variance);
    for (std::size_t i = 0; i < inverses.size(); ++i) {
        const double rest = std::max(0.0, pixel.beauty[i] - pixel.lamps[i]);
        inverses[i] = std::max(inverses[i], seldom.meanInverse(pixel.lamps[i], rest, offset));
    }
    return inverses;
}

}  // namespace

void FrameStore::readMeans(std::int32_t y, std::vector<NeighbourRows::Pixel>& row) const {
    std::fill(row.begin(), row.end(), NeighbourRows::Pixel{});
    if (y < m_window.y0 || y >= m_window.y1) return;
    const std::lock_guard lock(bandLock(y));
    std::size_t pixel = pixelIndex(m_window.x0, y);
    for (NeighbourRows::Pixel& to : row) {
        if (m_weights[pixel] > 0.0) {
            for (std::int32_t i = 0; i < kBeautyChannels; ++i)
                to.values[i] = mean(pixel, m_beautyFirst + i);
            to.sampled = true;
        }
        ++pixel;
    }
}

void FrameStore::visitError(std::int32_t x, std::int32_t y, const NeighbourRows& rows,
                            const ErrorVisitor& visit) const {
    const std::size_t pixel = pixelIndex(x, y);
    const Halves weights = halves(pixel);
    if (weights.even == 0 || weights.odd == 0) return;
    const double weight = m_weights[pixel], even = m_evenWeights[pixel], odd = weight - even;
    const auto meanEven = [&](std::int32_t channel) { return evenSum(pixel, channel) / even; };
    const auto meanOdd = [&](std::int32_t channel) {
        const double sum = m_sums[pixel * static_cast<std::size_t>(m_channels) +
                                  static_cast<std::size_t>(channel)];
        return (sum - evenSum(pixel, channel)) / odd;
    };
    // The halves' shares in the mean; see mean().
    const double share = isAdaptive() ? weights.even / (weights.even + weights.odd) : even / weight;
    PixelMeans means;
    for (std::int32_t i = 0; i < kBeautyChannels; ++i) {
        const auto to = static_cast<std::size_t>(i);
        const double apart = meanEven(m_beautyFirst + i) - meanOdd(m_beautyFirst + i);
        means.beauty[to] = mean(pixel, m_beautyFirst + i);
        means.lamps[to] = m_emissionFirst < 0 ? 0.0 : mean(pixel, m_emissionFirst + i);
        means.halves[to] = apart * apart * share * (1 - share);
        means.passes[to] = varianceOfMean(pixel, i);
    }
    const double offset = m_errorScale.offset();
    const Channels inverses =
        inverseSquares(means, static_cast<std::size_t>(x - m_window.x0), rows, offset);
    PixelError error;
    double change = 0, light = 0;
    for (std::int32_t i = 0; i < kBeautyChannels; ++i) {
        const auto to = static_cast<std::size_t>(i);
        const double inverse = inverses[to];
        error.noise += means.halves[to] * inverse;
        if (m_biasProbeFirst < 0) continue;
        const double square = meanEven(m_biasProbeFirst + i) * meanOdd(m_biasProbeFirst + i);
        error.bias += kBiasPerProbe * square * inverse;
        const double own = means.beauty[to] - means.lamps[to];
        change += square;
        light += own * own + offset;
    }
    error.isUnresolved = change > kUnresolvedChange * kUnresolvedChange * light;
    visit(x, y, error);
}

// Of the rows [begin,end).
void FrameStore::visitErrors(std::int32_t begin, std::int32_t end,
                             const ErrorVisitor& visit) const {
    const FpEnvironment guard;
    NeighbourRows rows(static_cast<std::size_t>(m_window.width()));
    if (begin > m_window.y0) readMeans(begin - 1, rows.nextRow());
    readMeans(begin, rows.nextRow());
    for (std::int32_t y = begin; y < end; ++y) {
        readMeans(y + 1, rows.nextRow());
        const std::lock_guard lock(bandLock(y));
        for (std::int32_t x = m_window.x0; x < m_window.x1; ++x) visitError(x, y, rows, visit);
    }
}

std::optional<FrameError> FrameStore::estimateError(bool inParallel) const {
    const FpEnvironment guard;
    FrameErrorSum sum(m_window);
    if (!inParallel) {
        visitErrors([&sum](std::int32_t x, std::int32_t y, const PixelError& pixel) {
            sum.add(x, y, pixel);
        });
        return sum.result();
    }
    // Some bands at a time, for the memory; added up in the order of their rows.
    struct Pixel {
        std::int32_t x{}, y{};
        PixelError error;
    };
    constexpr std::int32_t kRowsOfBand = 16, kBandsAtOnce = 64;
    std::vector<std::vector<Pixel>> bands(kBandsAtOnce);
    for (std::int32_t top = m_window.y0; top < m_window.y1; top += kRowsOfBand * kBandsAtOnce) {
        tbb::parallel_for(0, kBandsAtOnce, [&](std::int32_t band) {
            const std::int32_t begin = std::min(m_window.y1, top + band * kRowsOfBand);
            const std::int32_t end = std::min(m_window.y1, begin + kRowsOfBand);
            auto& pixels = bands[static_cast<std::size_t>(band)];
            pixels.clear();
            if (begin == end) return;
            visitErrors(begin, end,
                        [&pixels](std::int32_t x, std::int32_t y, const PixelError& error) {
                            pixels.push_back({x, y, error});
                        });
        });
        for (const auto& pixels : bands)
            for (const Pixel& pixel : pixels) sum.add(pixel.x, pixel.y, pixel.error);
    }
    return sum.result();
}

}  // namespace pm
