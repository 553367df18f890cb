// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/gather/surroundings.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "integrator/sampling/sampler.h"
#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// On a golden spiral (Vogel 1979).
constexpr std::uint32_t kRays = 8;
constexpr float kGoldenTurn = 0.381966011f;

}  // namespace

std::optional<float> Surroundings::distanceAlong(const Vec3f& direction, float farthest) const {
    Surface met;
    if (!m_scene.meet({m_position + m_normal * m_offset, direction, farthest}, met))
        return std::nullopt;
    return std::max(length(met.position - m_position), m_least);
}

float Surroundings::clearance(float farthest, std::uint32_t pattern) const {
    const Frame frame(m_normal);
    const std::uint64_t random = mixBits(pattern);
    const float turn = toUnitFloat(static_cast<std::uint32_t>(random));
    const float shift = toUnitFloat(static_cast<std::uint32_t>(random >> 32));
    float clearance = std::numeric_limits<float>::infinity();
    for (std::uint32_t i = 0; i < kRays; ++i) {
        const auto at = static_cast<float>(i);
        const float turns = turn + kGoldenTurn * at;
        const Vec3f direction = frame.toWorld(
            sampleCosineHemisphere({(at + shift) / kRays, turns - std::floor(turns)}));
        clearance = distanceAlong(direction, std::min(farthest, clearance)).value_or(clearance);
    }
    return clearance;
}

}  // namespace pm
