// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/film/frame_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <new>
#include <type_traits>

#include "integrator/values/error.h"
#include "scheduler/buckets/bucket_grid.h"
#include "scheduler/buckets/fp_environment.h"

namespace pm {
namespace {

std::size_t bandCount(const Rect& window) {
    return static_cast<std::size_t>(wholeAtoms(window).height() / kAtomSizePixels);
}

// Doubles that a pixel keeps of its even passes.
std::size_t evenChannels(std::int32_t channels, std::int32_t biasProbeFirst, bool adaptive) {
    if (adaptive) return static_cast<std::size_t>(channels);
    return biasProbeFirst < 0 ? FrameStore::kBeautyChannels : 2 * FrameStore::kBeautyChannels;
}

// Floats of SeenSamples.
constexpr std::int32_t kSeenChannels = 6;

// Of a rule's samples: floats of a pass that can't be read.
std::int32_t ruleChannels(bool adaptive, bool groups) {
    return adaptive ? kSeenChannels + (groups ? 1 : 0) : 0;
}

void addSeen(const float* values, SeenSamples& seen) {
    seen.samples += static_cast<double>(values[0]);
    for (int c = 0; c < 3; ++c) seen.sums[c] += static_cast<double>(values[c + 1]);
    seen.square += static_cast<double>(values[4]);
    seen.edges += static_cast<double>(values[5]);
    if (!(values[0] > 0.0f)) return;
    for (int c = 0; c < 3; ++c) {
        const auto sum = static_cast<double>(values[c + 1]);
        seen.ofPasses += sum * sum / static_cast<double>(values[0]);
    }
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
                       std::int32_t biasProbeFirst, std::int32_t emissionFirst,
                       const std::optional<SampleRule>& rule, const ErrorScale& errorScale)
    : m_window(window),
      m_area(wholeAtoms(window)),
      m_channels(channels - ruleChannels(rule.has_value(), rule && rule->groups)),
      m_beautyFirst(beautyFirst),
      m_biasProbeFirst(biasProbeFirst),
      m_emissionFirst(emissionFirst),
      m_rule(rule),
      m_errorScale(errorScale) {
    checkNotEmpty(window);
    checkChannels(m_channels, beautyFirst);
    checkOptional("bias probe", biasProbeFirst, m_channels);
    checkOptional("emission", emissionFirst, m_channels);
    if (rule) checkSampleRule(*rule);
    if (m_rule) m_rule->errorScale = errorScale;
    try {
        allocate();
    } catch (const std::exception&) {  // bad_alloc, or length_error for sizes beyond any memory
        throw Error(
            Status::kOutOfMemory,
            fmt::format("no memory for a frame of {} x {} pixels with {} channels: {} bytes",
                        window.width(), window.height(), channels,
                        memoryBytes(window, channels, biasProbeFirst, isAdaptive(), hasGroups())));
    }
}

void FrameStore::allocate() {
    const auto pixels = static_cast<std::size_t>(m_area.area());
    m_sums.resize(pixels * static_cast<std::size_t>(m_channels));
    m_weights.resize(pixels);
    m_deviations.resize(pixels * kBeautyChannels);
    m_passes.resize(pixels);
    m_evenSums.resize(pixels * evenChannels(m_channels, m_biasProbeFirst, isAdaptive()));
    m_evenWeights.resize(pixels);
    m_evenPasses.resize(pixels);
    if (m_rule) {
        m_allotted.assign(2 * pixels, static_cast<std::uint16_t>(m_rule->least));
        m_seen.resize(2 * pixels);
    }
    if (m_rule && m_rule->isAlone()) {
        m_passWeights = m_allotted;
        m_halfWeights.resize(2 * pixels);
    }
    if (hasGroups()) m_groups.assign(pixels, kUnseen);
    m_bandLocks = std::make_unique<std::mutex[]>(bandCount(m_window));
}

std::uint64_t FrameStore::memoryBytes(const Rect& window, std::int32_t channels,
                                      std::int32_t biasProbeFirst, bool adaptive, bool groups) {
    if (window.empty() || channels < 0) return sizeof(FrameStore);
    channels -= ruleChannels(adaptive, groups);
    const std::uint64_t pixelBytes =
        (static_cast<std::uint64_t>(channels) + 2 + kBeautyChannels +
         evenChannels(channels, biasProbeFirst, adaptive)) *
            sizeof(double) +
        2 * sizeof(std::uint32_t) +
        (adaptive ? 2 * (2 * sizeof(std::uint16_t) + sizeof(double) + sizeof(SeenSamples)) : 0) +
        (groups ? sizeof(float) : 0);
    return sizeof(FrameStore) + static_cast<std::uint64_t>(wholeAtoms(window).area()) * pixelBytes +
           bandCount(window) * sizeof(std::mutex);
}

void FrameStore::checkPass(const Rect& rect, std::size_t floats, std::size_t weights) const {
    if (intersect(rect, m_area) != rect || (isAdaptive() && wholeAtoms(rect) != rect)) {
        throw Error(
            Status::kInvalidArgument,
            fmt::format("pass of [{},{}) x [{},{}) is not {} the frame's window", rect.x0, rect.x1,
                        rect.y0, rect.y1, isAdaptive() ? "of whole atoms of" : "within"));
    }
    const auto area = static_cast<std::size_t>(rect.area());
    const std::size_t wanted = area * static_cast<std::size_t>(passChannels());
    if (floats != wanted || weights != area) {
        throw Error(Status::kInvalidArgument,
                    fmt::format("pass of {} pixels has {} floats and {} weights; it must have {} "
                                "and {}",
                                area, floats, weights, wanted, area));
    }
}

void FrameStore::addPass(std::uint32_t pass, const Rect& rect, std::span<const float> pixels,
                         std::span<const float> weights) {
    if (rect.empty()) return;
    checkPass(rect, pixels.size(), weights.size());
    const FpEnvironment guard;
    const auto channels = static_cast<std::size_t>(passChannels());
    std::size_t source = 0;
    for (std::int32_t y = rect.y0; y < rect.y1; ++y) {
        const std::lock_guard lock(bandLock(y));
        std::size_t pixel = pixelIndex(rect.x0, y);
        for (std::int32_t x = rect.x0; x < rect.x1; ++x, ++pixel, ++source) {
            if (!(weights[source] > 0.0f)) continue;
            const float* const values = pixels.data() + source * channels;
            const auto weight = static_cast<double>(weights[source]);
            if (hasGroups()) noteContribution(pixel, values[channels - 1]);
            addPixel(pixel, values, weight);
            if (pass % 2 == 0) addToEvenPasses(pixel, values, weight);
            if (!isAdaptive()) continue;
            addSeen(values + m_channels, m_seen[2 * pixel + pass % 2]);
            addWeightOfPass(pixel, pass);
        }
    }
    if (!isAdaptive() || !allotsAfter(*m_rule, pass + 1)) return;
    for (std::int32_t y = rect.y0; y < rect.y1; y += kAtomSizePixels) {
        const std::lock_guard lock(bandLock(y));
        for (std::int32_t x = rect.x0; x < rect.x1; x += kAtomSizePixels)
            allot({x, y, x + kAtomSizePixels, y + kAtomSizePixels}, pass + 1);
    }
}

std::int32_t FrameStore::passChannels() const {
    return m_channels + ruleChannels(isAdaptive(), hasGroups());
}

void FrameStore::addWeightOfPass(std::size_t pixel, std::uint32_t pass) {
    if (m_halfWeights.empty()) return;
    const std::size_t at = 2 * pixel + pass % 2;
    m_halfWeights[at] += madeUp(*m_rule, pass, m_halfWeights[at], m_passWeights[at]);
}

void FrameStore::noteContribution(std::size_t pixel, float contribution) {
    float& group = m_groups[pixel];
    if (group == kDivided) {
        forget(pixel);
        group = kOwn;
    } else if (group == kUnseen) {
        group = contribution;
    } else if (group != kOwn && group != contribution) {
        group = kUnlike;
    }
}

// What the pixel knows by samples of its group: those that divided it would bias it.
void FrameStore::forget(std::size_t pixel) {
    const auto clear = [pixel](auto& array, std::size_t perPixel) {
        std::fill_n(array.begin() + static_cast<std::ptrdiff_t>(pixel * perPixel), perPixel,
                    typename std::remove_reference_t<decltype(array)>::value_type{});
    };
    clear(m_sums, static_cast<std::size_t>(m_channels));
    clear(m_weights, 1);
    clear(m_deviations, kBeautyChannels);
    clear(m_passes, 1);
    clear(m_evenSums, evenChannels(m_channels, m_biasProbeFirst, isAdaptive()));
    clear(m_evenWeights, 1);
    clear(m_evenPasses, 1);
    clear(m_seen, 2);
}

void FrameStore::divideGroups(const Rect& atom) {
    for (std::int32_t y = atom.y0; y < atom.y1; y += 2)
        for (std::int32_t x = atom.x0; x < atom.x1; x += 2) {
            const std::size_t first = pixelIndex(x, y), below = pixelIndex(x, y + 1);
            const float group = m_groups[first];
            if (group == kDivided || group == kOwn) continue;
            if (group != kUnlike && !isDivided(*m_rule, m_seen[2 * first], m_seen[2 * first + 1]))
                continue;
            for (const std::size_t pixel : {first, first + 1, below, below + 1})
                m_groups[pixel] = kDivided;
        }
}

void FrameStore::allot(const Rect& atom, std::uint32_t passes) {
    if (hasGroups()) divideGroups(atom);
    allotHalf(atom, passes, passes % 2);
    // After the first pass the odd ones have seen nothing yet.
    if (m_rule->isAlone() && passes > 1) allotHalf(atom, passes, 1 - passes % 2);
}

// By what the other half has seen.
void FrameStore::allotHalf(const Rect& atom, std::uint32_t passes, std::size_t half) {
    std::array<SeenSamples, kAtomPixels> seen;
    std::array<std::uint16_t, kAtomPixels> samples{}, weights{};
    const auto forEachPixel = [&](const auto& use) {
        std::size_t i = 0;
        for (std::int32_t y = atom.y0; y < atom.y1; ++y)
            for (std::int32_t x = atom.x0; x < atom.x1; ++x, ++i) use(pixelIndex(x, y), i);
    };
    forEachPixel([&](std::size_t pixel, std::size_t i) { seen[i] = m_seen[2 * pixel + 1 - half]; });
    allotSamples(*m_rule, passes, seen, samples, weights);
    forEachPixel([&](std::size_t pixel, std::size_t i) {
        const std::size_t at = 2 * pixel + half;
        m_allotted[at] = samples[i];
        if (!m_passWeights.empty()) m_passWeights[at] = weights[i];
    });
}

void FrameStore::nextSamples(std::uint32_t pass, const Rect& rect,
                             std::span<NextSamples> next) const {
    auto to = next.begin();
    for (std::int32_t y = rect.y0; y < rect.y1; ++y) {
        const std::lock_guard lock(bandLock(y));
        for (std::int32_t x = rect.x0; x < rect.x1; ++x, ++to) {
            const std::size_t pixel = pixelIndex(x, y);
            const float group = hasGroups() ? m_groups[pixel] : kOwn;
            const double even = m_evenWeights[pixel];
            const double had = pass % 2 == 0 ? even : m_weights[pixel] - even;
            const double count = madeUp(*m_rule, pass, had, m_allotted[2 * pixel + pass % 2]);
            *to = {static_cast<std::uint32_t>(had), static_cast<std::uint32_t>(count)};
            if (group != kOwn) *to = {0, group == kDivided ? to->count : 0, group != kDivided};
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
    ++m_passes[pixel];
}

void FrameStore::addToEvenPasses(std::size_t pixel, const float* values, double weight) {
    double* sum =
        m_evenSums.data() + pixel * evenChannels(m_channels, m_biasProbeFirst, isAdaptive());
    const auto add = [&](std::int32_t first, std::int32_t count) {
        for (std::int32_t c = first; c < first + count; ++c)
            *sum++ += weight * static_cast<double>(values[c]);
    };
    if (isAdaptive()) {
        add(0, m_channels);
    } else {
        add(m_beautyFirst, kBeautyChannels);
        if (m_biasProbeFirst >= 0) add(m_biasProbeFirst, kBeautyChannels);
    }
    m_evenWeights[pixel] += weight;
    ++m_evenPasses[pixel];
}

double FrameStore::evenSum(std::size_t pixel, std::int32_t channel) const {
    const std::size_t first = pixel * evenChannels(m_channels, m_biasProbeFirst, isAdaptive());
    if (isAdaptive()) return m_evenSums[first + static_cast<std::size_t>(channel)];
    const bool ofProbe = m_biasProbeFirst >= 0 && channel >= m_biasProbeFirst &&
                         channel < m_biasProbeFirst + kBeautyChannels;
    const std::int32_t at =
        ofProbe ? kBeautyChannels + channel - m_biasProbeFirst : channel - m_beautyFirst;
    return m_evenSums[first + static_cast<std::size_t>(at)];
}

std::size_t FrameStore::pixelIndex(std::int32_t x, std::int32_t y) const {
    return static_cast<std::size_t>(y - m_area.y0) * static_cast<std::size_t>(m_area.width()) +
           static_cast<std::size_t>(x - m_area.x0);
}

std::mutex& FrameStore::bandLock(std::int32_t y) const {
    return m_bandLocks[static_cast<std::size_t>((y - m_area.y0) / kAtomSizePixels)];
}

}  // namespace pm
