// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/sky_parts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "integrator/sampling/pinned_math.h"

namespace pm {

namespace {

// Directions of which one is taken.
constexpr std::uint32_t kDirections = 8;

struct Candidate {
    Vec2f u;
    float worth;
};

// u moved by i steps of an even sequence, the generalised golden ratio (Roberts 2018), round the
// unit square.
Vec2f moved(Vec2f u, std::uint32_t i) {
    const auto around = [](double v) {
        return std::min(static_cast<float>(v - std::floor(v)), 1.0f - 0x1p-24f);
    };
    return {around(static_cast<double>(u.x) + 0.7548776662466927 * i),
            around(static_cast<double>(u.y) + 0.5698402909980532 * i)};
}

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
        candidate.u = moved(uDirection, i);
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
