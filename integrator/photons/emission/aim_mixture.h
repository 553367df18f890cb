// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "integrator/photons/emission/aim_cone.h"
#include "integrator/values/vec.h"

namespace pm {

// Of a scene, and of balls that stand for a part of one.
inline constexpr std::size_t kMostFound = 64, kMostBalls = 16;
inline constexpr std::size_t kMostCasters = kMostFound + kMostBalls;
inline constexpr std::uint32_t kNoCaster = ~0u;

// Directions from one point of emission: most of them within the cones towards casters, each as
// often as its solid angle times what it is worth; the rest unaimed. The density is that of the
// whole mixture, whichever part made the direction (Veach 1997, section 9.2.2.1, the one-sample
// balance heuristic).
class AimMixture {
  public:
    // Share of what is emitted unaimed. The cones hold all that light can be cast by, so it could
    // be 0; it keeps what is emitted as a whole right, and every flux within 1/kUnaimedShare of the
    // unaimed one.
    static constexpr float kUnaimedShare = 0.05f;

    struct Sample {
        Vec3f direction;  // unit
        float pdfSolidAngle = 0.0f;
        std::uint32_t caster = kNoCaster;  // what it was aimed at
    };

    // casters: at most kMostCasters. worth: of each caster, > 0.
    AimMixture(std::span<const Caster> casters, std::span<const float> worth,
               const EmissionPoint& from, float unaimedShare = kUnaimedShare);

    // False when the direction has no density.
    bool sample(float uChoice, Vec2f u, Sample& sample) const;
    float pdfSolidAngle(const Vec3f& direction) const;

  private:
    struct Part {
        AimCone cone;
        float share;
        std::uint32_t caster;
    };
    // Not initialised: that would take longer than aiming at a few casters.
    union Slot {
        Slot() {}
        Part part;
    };
    // Of all parts but `leftOut`.
    float pdfOfOthers(const Vec3f& direction, const Part* leftOut) const;

    const EmissionPoint& m_from;
    std::array<Slot, kMostCasters> m_slots;
    std::size_t m_count = 0;
    float m_unaimedShare = 1.0f;  // shares of cones that hold everything included
};

}  // namespace pm
