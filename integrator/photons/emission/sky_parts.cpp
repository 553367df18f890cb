// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/emission/sky_parts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "integrator/sampling/pinned_math.h"
#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// Directions of which one is taken.
constexpr std::uint32_t kDirections = 8;

struct Candidate {
    Vec2f u;
    float worth;
};

}  // namespace

std::uint32_t SkyParts::partOf(const Vec3f& seen) {
    const auto shareOf = [](double v) {
        return static_cast<std::uint32_t>(std::clamp(v, 0.0, 0.999999) * kBands);
    };
    const double around =
        pinnedAtan2Turns(static_cast<double>(seen.x), static_cast<double>(seen.z));
    return kBands * shareOf(0.5 + 0.5 * static_cast<double>(seen.y)) + shareOf(0.5 + around);
}

float SkyParts::choose(const Environment& environment, float& uChoice, Vec2f& uDirection) const {
    std::array<Candidate, kDirections> candidates;
    float total = 0.0f;
    for (std::uint32_t i = 0; i < kDirections; ++i) {
        Candidate& candidate = candidates[i];
        candidate.u = spreadPoint(i, uDirection);
        float pdf;
        candidate.worth = m_worth[partOf(environment.sample(candidate.u, pdf))];
        total += candidate.worth;
    }
    float left = uChoice * total;
    std::uint32_t chosen = 0;
    while (chosen + 1 < kDirections && left >= candidates[chosen].worth)
        left -= candidates[chosen++].worth;
    const float worth = candidates[chosen].worth;
    uChoice = std::clamp(left / worth, 0.0f, 1.0f - 0x1p-24f);
    uDirection = candidates[chosen].u;
    return total / (static_cast<float>(kDirections) * worth);
}

}  // namespace pm
