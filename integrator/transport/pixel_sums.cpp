// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/pixel_sums.h"

#include <algorithm>
#include <cstddef>

#include "integrator/sampling/sampler.h"

namespace pm {

namespace {

// Far above that of any picture, and a float.
constexpr double kLargestSquare = 1e36;

template <typename Triple>
void addTo(std::array<double, 3>& sum, const Triple& value) {
    for (int c = 0; c < 3; ++c) sum[static_cast<std::size_t>(c)] += static_cast<double>(value[c]);
}

void addSeen(const Rgb& beauty, std::array<double, 5>& seen) {
    ++seen[0];
    for (int c = 0; c < 3; ++c) {
        const auto value = static_cast<double>(beauty[c]);
        seen[static_cast<std::size_t>(c) + 1] += value;
        seen[4] += value * value;
    }
}

// ChannelLayout::contribution; 0 where the sample met nothing.
float contributionOf(const SampleRadiance& s) {
    if (s.coverage == 0.0f) return 0.0f;
    return static_cast<float>(1 + (combineBits(s.firstShape, s.firstMaterial) >> 40));
}

}  // namespace

bool PixelSums::accepts(const SampleRadiance& s) {
    return isFinite(s.emission) && isFinite(s.direct) && isFinite(s.caustic) &&
           isFinite(s.indirect) && isFinite(s.biasProbe);
}

void PixelSums::add(const SampleRadiance& s, double depth, bool isSeen) {
    addTo(m_emission, s.emission);
    addTo(m_direct, s.direct);
    addTo(m_caustic, s.caustic);
    addTo(m_indirect, s.indirect);
    addTo(m_biasProbe, s.biasProbe);
    if (isSeen) addSeen(s.emission + s.direct + s.caustic + s.indirect, m_seen);
    m_contribution = contributionOf(s);
    m_coverage += static_cast<double>(s.coverage);
    if (s.coverage == 0.0f) return;
    addTo(m_albedo, s.albedo);
    addTo(m_normal, s.normal);
    m_depth += depth;
}

void PixelSums::write(const ChannelLayout& layout, std::uint32_t samples, float* pixel) const {
    const double scale = 1.0 / samples;
    const auto put = [&](std::int32_t offset, const std::array<double, 3>& sum) {
        if (offset < 0) return;
        for (std::size_t c = 0; c < 3; ++c)
            pixel[static_cast<std::size_t>(offset) + c] = static_cast<float>(sum[c] * scale);
    };
    put(layout.direct, m_direct);
    put(layout.indirect, m_indirect);
    put(layout.caustic, m_caustic);
    put(layout.emission, m_emission);
    put(layout.biasProbe, m_biasProbe);
    for (std::size_t i = 0; i < m_seen.size() && layout.seen >= 0; ++i)
        pixel[static_cast<std::size_t>(layout.seen) + i] =
            static_cast<float>(std::min(m_seen[i], kLargestSquare));
    if (layout.contribution >= 0) pixel[layout.contribution] = m_contribution;
    put(layout.albedo, m_albedo);
    put(layout.normal, m_normal);
    pixel[layout.alpha] = static_cast<float>(m_coverage * scale);
    if (layout.depth >= 0) pixel[layout.depth] = static_cast<float>(m_depth * scale);
    for (int c = 0; c < 3; ++c)
        pixel[layout.beauty + c] = pixel[layout.direct + c] + pixel[layout.indirect + c] +
                                   pixel[layout.caustic + c] + pixel[layout.emission + c];
}

}  // namespace pm
