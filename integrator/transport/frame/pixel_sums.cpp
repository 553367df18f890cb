// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/frame/pixel_sums.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "integrator/sampling/sampler.h"

namespace pm {

namespace {

// Far above that of any picture, and a float.
constexpr double kLargestSquare = 1e36;
// Normals of a surface within one pixel: some 25 degrees apart. And of the way from one point of it
// to another the part along the normal.
constexpr float kLeastCosineAlike = 0.9f, kMostRiseAlike = 0.5f;

template <typename Triple>
void addTo(std::array<double, 3>& sum, const Triple& value) {
    for (int c = 0; c < 3; ++c) sum[static_cast<std::size_t>(c)] += static_cast<double>(value[c]);
}

// ChannelLayout::contribution; 0 where the sample met nothing.
float contributionOf(const SampleRadiance& s) {
    if (s.coverage == 0.0f) return 0.0f;
    return static_cast<float>(1 + (combineBits(s.firstShape, s.firstMaterial) >> 40));
}

bool has(SampleFault fault, const Rgb& c) {
    return std::ranges::any_of(std::array{c.r, c.g, c.b}, [fault](float value) {
        return fault == SampleFault::kNan ? std::isnan(value) : std::isinf(value);
    });
}

}  // namespace

std::optional<FaultySample> PixelSums::faultOf(const SampleRadiance& s) {
    const Rgb all = s.emission + s.direct + s.caustic + s.indirect;
    const auto isGood = [](const Rgb& c) { return isFinite(c) && c.r + c.g + c.b >= 0.0f; };
    if (isGood(s.emission) && isGood(s.direct) && isGood(s.caustic) && isGood(s.indirect) &&
        isFinite(all) && isFinite(s.biasProbe))
        return std::nullopt;
    const std::array<std::pair<const Rgb*, PathClass>, 6> parts{
        {{&s.emission, PathClass::kEmission},
         {&s.direct, PathClass::kDirect},
         {&s.caustic, PathClass::kCaustic},
         {&s.indirect, PathClass::kIndirect},
         {&s.biasProbe, PathClass::kIndirect},
         {&all, PathClass::kEmission}}};
    for (const auto fault : {SampleFault::kNan, SampleFault::kInfinite})
        for (const auto& [colour, part] : parts)
            if (has(fault, *colour)) return FaultySample{fault, part};
    const auto* negative =
        std::ranges::find_if_not(parts, [&](const auto& part) { return isGood(*part.first); });
    return FaultySample{SampleFault::kNegative, negative->second};
}

bool PixelSums::FirstHit::isUnlike(const FirstHit& other) const {
    if (any != other.any || !any) return any != other.any;
    if (shape != other.shape || material != other.material) return true;
    const Vec3f way = other.position - position;
    return dot(normal, other.normal) < kLeastCosineAlike ||
           std::abs(dot(way, normal)) > kMostRiseAlike * length(way);
}

void PixelSums::addSeen(const SampleRadiance& s) {
    const FirstHit hit{s.coverage > 0.0f, s.firstShape, s.firstMaterial, s.firstPosition, s.normal};
    if (m_seen[0] == 0)
        m_firstSeen = hit;
    else if (m_firstSeen.isUnlike(hit))
        m_seen[5] = 1;
    ++m_seen[0];
    const Rgb beauty = s.emission + s.direct + s.caustic + s.indirect;
    for (int c = 0; c < 3; ++c) {
        const auto value = static_cast<double>(beauty[c]);
        m_seen[static_cast<std::size_t>(c) + 1] += value;
        m_seen[4] += value * value;
    }
}

void PixelSums::add(const SampleRadiance& s, double depth, bool isSeen) {
    addTo(m_emission, s.emission);
    addTo(m_direct, s.direct);
    addTo(m_caustic, s.caustic);
    addTo(m_indirect, s.indirect);
    addTo(m_biasProbe, s.biasProbe);
    if (isSeen) addSeen(s);
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
