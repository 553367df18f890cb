// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/frame_store.h"

#include <fmt/format.h>

#include <new>

#include "integrator/values/error.h"
#include "scheduler/bucket_grid.h"
#include "scheduler/fp_environment.h"

namespace pm {
namespace {

std::size_t bandCount(const Rect& window) {
    return static_cast<std::size_t>(wholeAtoms(window).height() / kAtomSizePixels);
}

// Doubles that a pixel keeps of its even passes.
std::size_t evenChannels(std::int32_t biasProbeFirst) {
    return biasProbeFirst < 0 ? FrameStore::kBeautyChannels : 2 * FrameStore::kBeautyChannels;
}

void checkNotEmpty(const Rect& window) {
    checkWindow(window);
    if (window.empty()) {
        throw Error(Status::kInvalidArgument,
                    fmt::format("frame window is [{},{}) x [{},{}); it must hold a pixel",
                                window.x0, window.x1, window.y0, window.y1));
    }
}

void checkChannels(std::int32_t channels, std::int32_t beautyFirst) {
    if (channels < FrameStore::kBeautyChannels) {
        throw Error(Status::kInvalidArgument,
                    fmt::format("frame has {} channels; it must have >= {}", channels,
                                FrameStore::kBeautyChannels));
    }
    if (beautyFirst < 0 || beautyFirst > channels - FrameStore::kBeautyChannels) {
        throw Error(Status::kInvalidArgument,
                    fmt::format("first beauty channel is {}; it must be from 0 to {}", beautyFirst,
                                channels - FrameStore::kBeautyChannels));
    }
}

void checkOptional(const char* name, std::int32_t first, std::int32_t channels) {
    if (first < -1 || first > channels - FrameStore::kBeautyChannels) {
        throw Error(Status::kInvalidArgument,
                    fmt::format("first channel of the {} is {}; it must be -1 to {}", name, first,
                                channels - FrameStore::kBeautyChannels));
    }
}

}  // namespace

FrameStore::FrameStore(const Rect& window, std::int32_t channels, std::int32_t beautyFirst,
                       std::int32_t biasProbeFirst, std::int32_t emissionFirst)
    : m_window(window),
      m_channels(channels),
      m_beautyFirst(beautyFirst),
      m_biasProbeFirst(biasProbeFirst),
      m_emissionFirst(emissionFirst) {
    checkNotEmpty(window);
    checkChannels(channels, beautyFirst);
    checkOptional("bias probe", biasProbeFirst, channels);
    checkOptional("emission", emissionFirst, channels);
    const auto pixels = static_cast<std::size_t>(window.area());
    try {
        m_sums.resize(pixels * static_cast<std::size_t>(channels));
        m_weights.resize(pixels);
        m_deviations.resize(pixels * kBeautyChannels);
        m_passes.resize(pixels);
        m_evenSums.resize(pixels * evenChannels(biasProbeFirst));
        m_evenWeights.resize(pixels);
        m_bandLocks = std::make_unique<std::mutex[]>(bandCount(window));
    } catch (const std::exception&) {  // bad_alloc, or length_error for sizes beyond any memory
        throw Error(
            Status::kOutOfMemory,
            fmt::format("no memory for a frame of {} x {} pixels with {} channels: {} bytes",
                        window.width(), window.height(), channels,
                        memoryBytes(window, channels, biasProbeFirst)));
    }
}

std::uint64_t FrameStore::memoryBytes(const Rect& window, std::int32_t channels,
                                      std::int32_t biasProbeFirst) {
    if (window.empty() || channels < 0) return sizeof(FrameStore);
    const std::uint64_t pixelBytes = (static_cast<std::uint64_t>(channels) + 2 + kBeautyChannels +
                                      evenChannels(biasProbeFirst)) *
                                         sizeof(double) +
                                     sizeof(std::uint32_t);
    return sizeof(FrameStore) + static_cast<std::uint64_t>(window.area()) * pixelBytes +
           bandCount(window) * sizeof(std::mutex);
}

void FrameStore::addPass(const Rect& rect, std::span<const float> pixels,
                         std::span<const float> weights) {
    if (rect.empty()) return;
    if (intersect(rect, m_window) != rect) {
        throw Error(Status::kInvalidArgument,
                    fmt::format("pass of [{},{}) x [{},{}) is not within the frame's window",
                                rect.x0, rect.x1, rect.y0, rect.y1));
    }
    const FpEnvironment guard;
    const auto area = static_cast<std::size_t>(rect.area());
    const auto channels = static_cast<std::size_t>(m_channels);
    if (pixels.size() != area * channels || weights.size() != area) {
        throw Error(Status::kInvalidArgument,
                    fmt::format("pass of {} pixels has {} floats and {} weights; it must have {} "
                                "and {}",
                                area, pixels.size(), weights.size(), area * channels, area));
    }
    std::size_t source = 0;
    for (std::int32_t y = rect.y0; y < rect.y1; ++y) {
        const std::lock_guard lock(bandLock(y));
        std::size_t pixel = pixelIndex(rect.x0, y);
        for (std::int32_t x = rect.x0; x < rect.x1; ++x, ++pixel, ++source) {
            if (!(weights[source] > 0.0f)) continue;
            addPixel(pixel, pixels.data() + source * channels,
                     static_cast<double>(weights[source]));
        }
    }
}

void FrameStore::addPixel(std::size_t pixel, const float* values, double weight) {
    const double oldWeight = m_weights[pixel];
    const double newWeight = oldWeight + weight;
    double* const sums = m_sums.data() + pixel * static_cast<std::size_t>(m_channels);
    double* const deviations = m_deviations.data() + pixel * kBeautyChannels;
    for (std::int32_t i = 0; i < kBeautyChannels && oldWeight > 0.0; ++i) {
        const double value = static_cast<double>(values[m_beautyFirst + i]);
        const double sum = sums[m_beautyFirst + i];
        const double oldMean = sum / oldWeight;
        const double newMean = (sum + weight * value) / newWeight;
        deviations[i] += weight * (value - oldMean) * (value - newMean);
    }
    for (std::int32_t c = 0; c < m_channels; ++c) {
        sums[c] += weight * static_cast<double>(values[c]);
    }
    m_weights[pixel] = newWeight;
    if (m_passes[pixel]++ % 2 == 0) addToEvenPasses(pixel, values, weight);
}

void FrameStore::addToEvenPasses(std::size_t pixel, const float* values, double weight) {
    double* const sums = m_evenSums.data() + pixel * evenChannels(m_biasProbeFirst);
    for (std::int32_t i = 0; i < kBeautyChannels; ++i) {
        sums[i] += weight * static_cast<double>(values[m_beautyFirst + i]);
        if (m_biasProbeFirst < 0) continue;
        sums[kBeautyChannels + i] += weight * static_cast<double>(values[m_biasProbeFirst + i]);
    }
    m_evenWeights[pixel] += weight;
}

std::size_t FrameStore::pixelIndex(std::int32_t x, std::int32_t y) const {
    return static_cast<std::size_t>(y - m_window.y0) * static_cast<std::size_t>(m_window.width()) +
           static_cast<std::size_t>(x - m_window.x0);
}

std::mutex& FrameStore::bandLock(std::int32_t y) const {
    const std::int32_t firstRow = wholeAtoms(m_window).y0;
    return m_bandLocks[static_cast<std::size_t>((y - firstRow) / kAtomSizePixels)];
}

}  // namespace pm
