// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/film/frame_error.h"

#include <cmath>
#include <limits>

namespace pm {
namespace {

constexpr double kChannels = 3;
// Samples that saw a lamp, from which on their number is known well enough.
constexpr double kManySeen = 30;

std::int32_t squareOf(std::int32_t from, std::int32_t at) {
    return (at - from) / kErrorSquarePixels;
}

// Of the sum of the squares' values, each held against its share of the mean.
template <typename Value>
double standardErrorOfSum(std::span<const ErrorSquare> squares, double mean, Value value) {
    double variance = 0, count = 0;
    for (const ErrorSquare& square : squares) {
        if (square.pixels == 0) continue;
        const double off = value(square) - kChannels * square.pixels * mean;
        variance += off * off;
        ++count;
    }
    return std::sqrt(variance * count / (count - 1));
}

}  // namespace

bool FrameError::isLowerBound() const {
    return unresolvedShare > kErrorTrimmedShare;
}

void ErrorSquare::add(const PixelError& pixel) {
    noise += pixel.noise;
    bias += pixel.bias;
    unresolved += pixel.isUnresolved ? 1.0 : 0.0;
    ++pixels;
}

void addSpread(std::span<const ErrorSquare> squares, FrameError& error) {
    double pixels = 0, unresolved = 0, count = 0;
    for (const ErrorSquare& square : squares) {
        pixels += square.pixels;
        unresolved += square.unresolved;
        count += square.pixels > 0 ? 1.0 : 0.0;
    }
    error.unresolvedShare = unresolved / pixels;
    if (count < 2) return;
    const double values = kChannels * pixels;
    error.biasStandardError =
        standardErrorOfSum(squares, error.bias, [](const ErrorSquare& s) { return s.bias; }) /
        values;
    const double ofNoise =
        standardErrorOfSum(squares, error.noise, [](const ErrorSquare& s) { return s.noise; }) /
        values;
    // No more than there are values, however alike the squares.
    if (error.noise > 0.0)
        error.noiseDegreesOfFreedom =
            std::min(values, 2 * error.noise * error.noise / (ofNoise * ofNoise));
}

FrameErrorSum::FrameErrorSum(const Rect& window)
    : m_window(window), m_columns(squareOf(window.x0, window.x1 - 1) + 1) {
    const std::int32_t rows = squareOf(window.y0, window.y1 - 1) + 1;
    m_squares.resize(static_cast<std::size_t>(m_columns) * static_cast<std::size_t>(rows));
    m_noise.reserve(static_cast<std::size_t>(window.area()));
}

void FrameErrorSum::add(std::int32_t x, std::int32_t y, const PixelError& pixel) {
    m_noise.push_back(pixel.noise);
    const auto row = static_cast<std::size_t>(squareOf(m_window.y0, y));
    const auto column = static_cast<std::size_t>(squareOf(m_window.x0, x));
    m_squares[row * static_cast<std::size_t>(m_columns) + column].add(pixel);
}

double FrameErrorSum::trimmedNoise() const {
    const auto dropped = static_cast<std::size_t>(
        std::ceil(kErrorTrimmedShare * static_cast<double>(m_noise.size())));
    std::vector<double> sorted = m_noise;
    const auto limit = sorted.end() - static_cast<std::ptrdiff_t>(dropped);
    std::nth_element(sorted.begin(), limit, sorted.end());
    // Summed in pixel order; of those that equal the limit, as many as stay.
    const double most = *limit;
    auto equal = std::count(sorted.begin(), limit, most);
    CompensatedSum sum;
    for (const double value : m_noise) {
        if (value < most || (value == most && equal-- > 0)) sum.add(value);
    }
    return sum.value() / (kChannels * static_cast<double>(m_noise.size()));
}

std::optional<FrameError> FrameErrorSum::result() const {
    if (m_noise.empty()) return std::nullopt;
    const double values = kChannels * static_cast<double>(m_noise.size());
    CompensatedSum noise, bias;
    for (const double value : m_noise) noise.add(value);
    for (const ErrorSquare& square : m_squares) bias.add(square.bias);
    FrameError error;
    error.noise = noise.value() / values;
    error.bias = bias.value() / values;
    // NaN has no order: one pixel of it makes the frame's error NaN.
    error.noiseTrimmed = std::isnan(error.noise) ? error.noise : trimmedNoise();
    addSpread(m_squares, error);
    return error;
}

SeldomLight::SeldomLight(double lampSquare, double variance)
    : m_seen(std::max(1.0, lampSquare / variance)), m_many(!(m_seen < kManySeen)) {
    if (m_many) return;
    // Even steps of the count's logarithm.
    constexpr double kLeast = 1e-6, kMost = 2 * kManySeen;
    const double step = std::log(kMost / kLeast) / static_cast<double>(kNodes - 1);
    double sum = 0;
    for (std::size_t i = 0; i < kNodes; ++i) {
        const double logarithm = std::log(kLeast) + step * static_cast<double>(i);
        m_counts[i] = std::exp(logarithm);
        m_weights[i] = std::exp((m_seen + 1) * logarithm - m_counts[i]);
        sum += m_weights[i];
    }
    for (double& weight : m_weights) weight /= sum;
}

double SeldomLight::meanInverse(double lamp, double rest, double offset) const {
    if (m_many) return 1 / ((lamp + rest) * (lamp + rest) + offset);
    const double each = lamp / m_seen;
    double mean = 0;
    for (std::size_t i = 0; i < kNodes; ++i) {
        const double truth = rest + each * m_counts[i];
        mean += m_weights[i] / (truth * truth + offset);
    }
    return mean;
}

NeighbourRows::NeighbourRows(std::size_t width) {
    for (std::vector<Pixel>& row : m_rows) row.resize(width);
}

std::vector<NeighbourRows::Pixel>& NeighbourRows::nextRow() {
    return m_rows[m_next++ % 3];
}

Neighbours NeighbourRows::around(std::size_t x, std::size_t channel) const {
    constexpr std::int32_t kFew = 4;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    double lowest = kInfinity, second = kInfinity, highest = -kInfinity, secondHighest = -kInfinity;
    Neighbours found;
    for (std::size_t row = 0; row < 3; ++row) {
        const std::vector<Pixel>& pixels = m_rows[(m_next + row) % 3];  // from the oldest on
        for (std::size_t i = x - std::min<std::size_t>(x, 1); i <= x + 1 && i < pixels.size();
             ++i) {
            if ((row == 1 && i == x) || !pixels[i].sampled) continue;
            const double value = pixels[i].values[channel];
            found.mean += value;
            ++found.count;
            second = std::min(second, std::max(lowest, value));
            lowest = std::min(lowest, value);
            secondHighest = std::max(secondHighest, std::min(highest, value));
            highest = std::max(highest, value);
        }
    }
    if (found.count == 0) return found;
    found.mean /= found.count;
    found.low = found.count > kFew ? second : lowest;
    found.high = found.count > kFew ? secondHighest : highest;
    return found;
}

}  // namespace pm
