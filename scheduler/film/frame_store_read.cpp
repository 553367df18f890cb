// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors

// What is read out of the frame store, beside frame_store.cpp, which fills it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "integrator/values/error.h"
#include "scheduler/buckets/fp_environment.h"
#include "scheduler/film/frame_store.h"

namespace pm {

FrameStore::Halves FrameStore::halves(std::size_t pixel) const {
    if (!m_halfWeights.empty()) return {m_halfWeights[2 * pixel], m_halfWeights[2 * pixel + 1]};
    const double even = m_evenPasses[pixel];
    return {even, m_passes[pixel] - even};
}

double FrameStore::mean(std::size_t pixel, std::int32_t channel) const {
    const double weight = m_weights[pixel];
    if (!(weight > 0.0)) return 0.0;
    const double sum =
        m_sums[pixel * static_cast<std::size_t>(m_channels) + static_cast<std::size_t>(channel)];
    if (!isAdaptive()) return sum / weight;
    const auto [even, odd] = halves(pixel);
    if (even == 0.0 || odd == 0.0) return sum / weight;
    const double evenWeight = m_evenWeights[pixel], ofEven = evenSum(pixel, channel);
    return (even * (ofEven / evenWeight) + odd * ((sum - ofEven) / (weight - evenWeight))) /
           (even + odd);
}

double FrameStore::varianceOfMean(std::size_t pixel, std::int32_t beautyChannel) const {
    const double m2 =
        m_deviations[pixel * kBeautyChannels + static_cast<std::size_t>(beautyChannel)];
    // Rounding can leave a tiny negative sum where all passes agree; NaN is to stay NaN.
    const double deviation = m2 < 0.0 ? 0.0 : m2;
    const double ofSample = deviation / static_cast<double>(m_passes[pixel] - 1);
    const auto [even, odd] = halves(pixel);
    if (!isAdaptive() || even == 0.0 || odd == 0.0) return ofSample / m_weights[pixel];
    const double evenWeight = m_evenWeights[pixel], oddWeight = m_weights[pixel] - evenWeight;
    const double evenShare = even / (even + odd), oddShare = odd / (even + odd);
    return ofSample * (evenShare * evenShare / evenWeight + oddShare * oddShare / oddWeight);
}

// Of means of n_e and n_o passes with the variance v a pass the difference has v (1/n_e + 1/n_o),
// the mean of all v / (n_e + n_o).
double FrameStore::halfDifference(std::size_t pixel, std::int32_t beautyChannel) const {
    const auto [even, odd] = halves(pixel);
    const double evenWeight = m_evenWeights[pixel], oddWeight = m_weights[pixel] - evenWeight;
    if (!(even > 0.0 && odd > 0.0 && evenWeight > 0.0 && oddWeight > 0.0)) return 0.0;
    const std::int32_t channel = m_beautyFirst + beautyChannel;
    const double sum =
        m_sums[pixel * static_cast<std::size_t>(m_channels) + static_cast<std::size_t>(channel)];
    const double ofEven = evenSum(pixel, channel);
    return std::sqrt(even * odd) / (even + odd) *
           (ofEven / evenWeight - (sum - ofEven) / oddWeight);
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

void FrameStore::readHalfDifference(const Rect& rect, float* destination,
                                    std::int64_t pixelStrideBytes,
                                    std::int64_t rowStrideBytes) const {
    readRows(rect, kBeautyChannels, destination, pixelStrideBytes, rowStrideBytes,
             [&](std::size_t pixel, float* values) {
                 for (std::int32_t i = 0; i < kBeautyChannels; ++i)
                     values[i] = static_cast<float>(halfDifference(pixel, i));
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

bool FrameStore::showsGroup(std::int32_t x, std::int32_t y) const {
    if (!hasGroups() || !m_window.contains(x, y)) return false;
    const std::lock_guard lock(bandLock(y));
    return m_groups[pixelIndex(x, y)] != kOwn;
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

}  // namespace pm
