// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/gather/gather_guide.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "integrator/photons/emission/flux_steps.h"

namespace pm {

namespace {

constexpr std::size_t kEmitters = 128;
// Of the rays that follow the photons.
constexpr float kGuided = 0.5f;

// The cell of a rising table from 0 to 1 that u falls into, and how far.
template <std::size_t kCount>
std::size_t cellOf(const std::array<float, kCount>& table, float u) {
    const auto last = table.end() - 1;
    return static_cast<std::size_t>(std::upper_bound(table.begin() + 1, last, u) - table.begin()) -
           1;
}

template <std::size_t kCount>
float within(const std::array<float, kCount>& table, std::size_t cell, float u) {
    const float share = (u - table[cell]) / (table[cell + 1] - table[cell]);
    return std::min(std::max(share, 0.0f), 0x1.fffffep-1f);
}

}  // namespace

GatherGuide::GatherGuide(const PhotonMap& photons, float radius)
    : m_nearestSquared(radius * radius) {
    for (const auto& [photon, share] : drawBySteps(photons, kEmitters, 0.5f).photons)
        m_emitters.push_back({photon.position, photon.normal.unpack()});
}

GatherGuide::Directions GatherGuide::at(const Vec3f& position, const Frame& frame) const {
    constexpr std::size_t kTurns = Directions::kTurns, kSines = Directions::kSines;
    std::array<std::array<float, kSines>, kTurns> light{};
    float sum = 0;
    for (const Emitter& emitter : m_emitters) {
        const Vec3f away = emitter.position - position;
        const float height = dot(away, frame.normal), facing = -dot(away, emitter.normal);
        if (!(height > 0.0f && facing > 0.0f)) continue;
        const float squared = lengthSquared(away);
        const float x = dot(away, frame.tangent), y = dot(away, frame.bitangent);
        const float turns = std::atan2(y, x) * (0.5f * kInvPi);
        const float sine = (x * x + y * y) / squared;
        const auto turn = static_cast<std::size_t>((turns - std::floor(turns)) * kTurns);
        const auto cell = static_cast<std::size_t>(sine * kSines);
        const float arrives = height * facing / (squared * std::max(squared, m_nearestSquared));
        light[std::min(turn, kTurns - 1)][std::min(cell, kSines - 1)] += arrives;
        sum += arrives;
    }
    Directions result;
    const float even = (sum > 0.0f ? 1.0f - kGuided : 1.0f) / (kTurns * kSines);
    const float scale = sum > 0.0f ? kGuided / sum : 0.0f;
    for (std::size_t turn = 0; turn < kTurns; ++turn) {
        auto& sines = result.m_sines[turn];
        for (std::size_t i = 0; i < kSines; ++i)
            sines[i + 1] = sines[i] + (even + scale * light[turn][i]);
        const float ofTurn = sines[kSines];
        result.m_turns[turn + 1] = result.m_turns[turn] + ofTurn;
        for (float& upTo : sines) upTo /= ofTurn;
    }
    for (float& upTo : result.m_turns) upTo /= result.m_turns[kTurns];
    return result;
}

GatherGuide::Directions::Warped GatherGuide::Directions::warp(Vec2f u) const {
    const std::size_t turn = cellOf(m_turns, u.y);
    const auto& sines = m_sines[turn];
    const std::size_t sine = cellOf(sines, u.x);
    const float density = (m_turns[turn + 1] - m_turns[turn]) * (sines[sine + 1] - sines[sine]) *
                          static_cast<float>(kTurns * kSines);
    const auto place = [](std::size_t cell, float share, std::size_t cells) {
        return std::min((static_cast<float>(cell) + share) / static_cast<float>(cells),
                        0x1.fffffep-1f);
    };
    return {{place(sine, within(sines, sine, u.x), kSines),
             place(turn, within(m_turns, turn, u.y), kTurns)},
            density};
}

}  // namespace pm
