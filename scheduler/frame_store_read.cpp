// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors

// What is read out of the frame store, beside frame_store.cpp, which fills it.
#include "scheduler/frame_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "integrator/values/error.h"
#include "scheduler/fp_environment.h"

namespace pm {
namespace {

// Neumaier's sum: keeps what plain addition rounds away, so that millions of pixels add up to the
// last bits of a double.
class CompensatedSum {
  public:
    void add(double value) {
        const double sum = m_sum + value;
        m_lost +=
            std::abs(m_sum) >= std::abs(value) ? (m_sum - sum) + value : (value - sum) + m_sum;
        m_sum = sum;
    }
    double value() const { return m_sum + m_lost; }

  private:
    double m_sum{}, m_lost{};
};

// The constant of relMSE = mean of (x - r)^2 / (r^2 + 0.01), which keeps black pixels finite.
constexpr double kRelMseOffset = 0.01;

}  // namespace

double FrameStore::mean(std::size_t pixel, std::int32_t channel) const {
    const double weight = m_weights[pixel];
    const std::size_t at =
        pixel * static_cast<std::size_t>(m_channels) + static_cast<std::size_t>(channel);
    return weight > 0.0 ? m_sums[at] / weight : 0.0;
}

double FrameStore::varianceOfMean(std::size_t pixel, std::int32_t beautyChannel) const {
    const double m2 =
        m_deviations[pixel * kBeautyChannels + static_cast<std::size_t>(beautyChannel)];
    // Rounding can leave a tiny negative sum where all passes agree; NaN is to stay NaN.
    const double deviation = m2 < 0.0 ? 0.0 : m2;
    return deviation / (static_cast<double>(m_passes[pixel] - 1) * m_weights[pixel]);
}

template <typename ReadPixel>
void FrameStore::readRows(const Rect& rect, std::int32_t floatsPerPixel, float* destination,
                          std::int64_t pixelStrideBytes, std::int64_t rowStrideBytes,
                          ReadPixel readPixel) const {
    if (rect.empty() || floatsPerPixel == 0) return;
    const FpEnvironment guard;
    const std::size_t bytes = static_cast<std::size_t>(floatsPerPixel) * sizeof(float);
    std::vector<float> values(static_cast<std::size_t>(floatsPerPixel));
    char* row = reinterpret_cast<char*>(destination);
    for (std::int32_t y = rect.y0; y < rect.y1; ++y, row += rowStrideBytes) {
        const bool rowInside = y >= m_window.y0 && y < m_window.y1;
        std::unique_lock<std::mutex> lock;
        if (rowInside) lock = std::unique_lock(bandLock(y));
        char* at = row;
        for (std::int32_t x = rect.x0; x < rect.x1; ++x, at += pixelStrideBytes) {
            if (rowInside && x >= m_window.x0 && x < m_window.x1) {
                readPixel(pixelIndex(x, y), values.data());
            } else {
                std::fill(values.begin(), values.end(), 0.0f);
            }
            std::memcpy(at, values.data(), bytes);
        }
    }
}

void FrameStore::read(const Rect& rect, std::int32_t firstChannel, std::int32_t channelCount,
                      float* destination, std::int64_t pixelStrideBytes,
                      std::int64_t rowStrideBytes) const {
    if (firstChannel < 0 || channelCount < 0 || firstChannel > m_channels - channelCount) {
        throw Error(Status::kInvalidArgument,
                    fmt::format("reading {} channels from channel {} on; the frame has {}",
                                channelCount, firstChannel, m_channels));
    }
    readRows(rect, channelCount, destination, pixelStrideBytes, rowStrideBytes,
             [&](std::size_t pixel, float* values) {
                 for (std::int32_t c = 0; c < channelCount; ++c) {
                     values[c] = static_cast<float>(mean(pixel, firstChannel + c));
                 }
             });
}

void FrameStore::readStandardError(const Rect& rect, float* destination,
                                   std::int64_t pixelStrideBytes,
                                   std::int64_t rowStrideBytes) const {
    readRows(rect, kBeautyChannels, destination, pixelStrideBytes, rowStrideBytes,
             [&](std::size_t pixel, float* values) {
                 for (std::int32_t i = 0; i < kBeautyChannels; ++i) {
                     const bool known = m_passes[pixel] >= 2;
                     values[i] =
                         known ? static_cast<float>(std::sqrt(varianceOfMean(pixel, i))) : 0.0f;
                 }
             });
}

void FrameStore::readSampleCount(const Rect& rect, float* destination,
                                 std::int64_t pixelStrideBytes, std::int64_t rowStrideBytes) const {
    readRows(rect, 1, destination, pixelStrideBytes, rowStrideBytes,
             [&](std::size_t pixel, float* values) {
                 values[0] = static_cast<float>(m_weights[pixel]);
             });
}

double FrameStore::sampleCount(std::int32_t x, std::int32_t y) const {
    if (!m_window.contains(x, y)) return 0.0;
    const std::lock_guard lock(bandLock(y));
    return m_weights[pixelIndex(x, y)];
}

std::optional<std::array<float, 3>> FrameStore::standardError(std::int32_t x,
                                                              std::int32_t y) const {
    if (!m_window.contains(x, y)) return std::nullopt;
    const FpEnvironment guard;
    const std::lock_guard lock(bandLock(y));
    const std::size_t pixel = pixelIndex(x, y);
    if (m_passes[pixel] < 2) return std::nullopt;
    std::array<float, 3> error{};
    for (std::int32_t i = 0; i < kBeautyChannels; ++i) {
        error[static_cast<std::size_t>(i)] =
            static_cast<float>(std::sqrt(varianceOfMean(pixel, i)));
    }
    return error;
}

std::vector<double> FrameStore::beautyRow(std::int32_t y) const {
    const auto width = static_cast<std::size_t>(m_window.width());
    std::vector<double> row(width * kBeautyChannels, std::numeric_limits<double>::quiet_NaN());
    if (y < m_window.y0 || y >= m_window.y1) return row;
    const std::lock_guard lock(bandLock(y));
    for (std::size_t x = 0; x < width; ++x) {
        const std::size_t pixel = pixelIndex(m_window.x0 + static_cast<std::int32_t>(x), y);
        if (m_passes[pixel] == 0) continue;
        for (std::int32_t i = 0; i < kBeautyChannels; ++i)
            row[x * kBeautyChannels + static_cast<std::size_t>(i)] = mean(pixel, m_beautyFirst + i);
    }
    return row;
}

namespace {

// The median of a channel over a pixel and its neighbours, those without samples (NaN) left out.
double medianAround(const std::array<std::vector<double>, 3>& rows, std::size_t x,
                    std::size_t channel, std::size_t channels) {
    std::array<double, 9> values;
    std::size_t count = 0;
    const std::size_t width = rows[1].size() / channels;
    for (const std::vector<double>& row : rows)
        for (std::size_t at = x > 0 ? x - 1 : 0; at < std::min(x + 2, width); ++at) {
            const double value = row[at * channels + channel];
            if (!std::isnan(value)) values[count++] = value;
        }
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(values.begin(), middle, values.begin() + static_cast<std::ptrdiff_t>(count));
    return *middle;
}

}  // namespace

std::optional<double> FrameStore::estimatedRelMse() const {
    const FpEnvironment guard;
    CompensatedSum sum;
    std::uint64_t terms = 0;
    std::array<std::vector<double>, 3> rows = {beautyRow(m_window.y0 - 1), beautyRow(m_window.y0),
                                               beautyRow(m_window.y0 + 1)};
    for (std::int32_t y = m_window.y0; y < m_window.y1; ++y) {
        {
            const std::lock_guard lock(bandLock(y));
            for (std::int32_t x = m_window.x0; x < m_window.x1; ++x) {
                const std::size_t pixel = pixelIndex(x, y);
                if (m_passes[pixel] < 2) continue;
                for (std::int32_t i = 0; i < kBeautyChannels; ++i) {
                    const double level =
                        medianAround(rows, static_cast<std::size_t>(x - m_window.x0),
                                     static_cast<std::size_t>(i), kBeautyChannels);
                    sum.add(varianceOfMean(pixel, i) / (level * level + kRelMseOffset));
                }
                terms += kBeautyChannels;
            }
        }
        std::rotate(rows.begin(), rows.begin() + 1, rows.end());
        rows[2] = beautyRow(y + 2);
    }
    if (terms == 0) return std::nullopt;
    return sum.value() / static_cast<double>(terms);
}

}  // namespace pm
