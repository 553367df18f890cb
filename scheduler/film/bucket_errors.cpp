// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/film/bucket_errors.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "scheduler/buckets/fp_environment.h"
#include "scheduler/film/compensated_sum.h"

namespace pm {
namespace {

constexpr double kChannels = 3;

std::int32_t squaresAcross(const BucketGrid& grid) {
    return (grid.bucketSize() - 1) / kErrorSquarePixels + 1;
}

std::size_t trimmedPixels(double pixels) {
    return static_cast<std::size_t>(std::ceil(kErrorTrimmedShare * pixels));
}

}  // namespace

BucketErrors::BucketErrors(const BucketGrid& grid)
    : m_squareColumns(squaresAcross(grid)),
      m_squaresPerBucket(static_cast<std::size_t>(m_squareColumns) *
                         static_cast<std::size_t>(m_squareColumns)),
      m_mostNoisy(trimmedPixels(static_cast<double>(grid.window().area()))),
      m_squares(grid.cellCount() * m_squaresPerBucket) {
    m_noisiest.reserve(m_mostNoisy);
}

std::uint64_t BucketErrors::memoryBytes(const BucketGrid& grid) {
    const auto across = static_cast<std::uint64_t>(squaresAcross(grid));
    // The noisiest pixels twice: they are sorted in a copy.
    return grid.cellCount() * across * across * sizeof(ErrorSquare) +
           2 * trimmedPixels(static_cast<double>(grid.window().area())) * sizeof(double);
}

void BucketErrors::add(std::uint32_t cell, const FrameStore& frame) {
    const FpEnvironment guard;
    const Rect& window = frame.window();
    std::vector<ErrorSquare> squares(m_squaresPerBucket);
    std::vector<double> noises;
    frame.visitErrors([&](std::int32_t x, std::int32_t y, const PixelError& pixel) {
        const std::int32_t column = (x - window.x0) / kErrorSquarePixels;
        const std::int32_t row = (y - window.y0) / kErrorSquarePixels;
        squares[static_cast<std::size_t>(row * m_squareColumns + column)].add(pixel);
        // NaN has no order.
        if (!std::isnan(pixel.noise)) noises.push_back(pixel.noise);
    });
    const std::lock_guard lock(m_mutex);
    std::copy(squares.begin(), squares.end(),
              m_squares.begin() + static_cast<std::ptrdiff_t>(cell * m_squaresPerBucket));
    for (const double noise : noises) {
        if (m_noisiest.size() == m_mostNoisy) {
            if (m_noisiest.empty() || noise <= m_noisiest.front()) continue;
            std::pop_heap(m_noisiest.begin(), m_noisiest.end(), std::greater<>());
            m_noisiest.pop_back();
        }
        m_noisiest.push_back(noise);
        std::push_heap(m_noisiest.begin(), m_noisiest.end(), std::greater<>());
    }
}

double BucketErrors::trimmedNoise(double noise, double pixels) const {
    std::vector<double> noisiest = m_noisiest;
    std::sort(noisiest.begin(), noisiest.end(), std::greater<>());
    noisiest.resize(std::min(noisiest.size(), trimmedPixels(pixels)));
    CompensatedSum dropped;
    for (const double value : noisiest) dropped.add(value);
    return std::max(0.0, noise - dropped.value());
}

std::optional<FrameError> BucketErrors::result() const {
    const FpEnvironment guard;
    const std::lock_guard lock(m_mutex);
    CompensatedSum noise, bias;
    double pixels = 0;
    for (const ErrorSquare& square : m_squares) {
        noise.add(square.noise);
        bias.add(square.bias);
        pixels += square.pixels;
    }
    if (pixels == 0) return std::nullopt;
    const double values = kChannels * pixels;
    FrameError error;
    error.noise = noise.value() / values;
    error.bias = bias.value() / values;
    error.noiseTrimmed =
        std::isnan(error.noise) ? error.noise : trimmedNoise(noise.value(), pixels) / values;
    addSpread(m_squares, error);
    return error;
}

}  // namespace pm
