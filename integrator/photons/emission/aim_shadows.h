// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "integrator/lights/box_shadow.h"
#include "integrator/photons/emission/aim_mixture.h"
#include "integrator/values/vec.h"

namespace pm {

// Points through which parallel light goes, for what shines from infinitely far: most of them in
// the shadows that casters throw on a plane across the light, each as often as its area times what
// it is worth; the rest anywhere in the shadow of the scene's box. A caster's shadow is its ball's
// or its box's, whichever is smaller. The density is that of the whole mixture, as AimMixture's is.
class AimShadows {
  public:
    struct Sample {
        Vec3d point;           // scene's own coordinates; any point along the light is the same
        double pdfArea = 0.0;  // across the light, over scene units squared
        std::uint32_t caster = kNoCaster;  // what it was aimed at
    };

    // casters: at most kMostCasters. worth: of each caster, > 0. direction: in which light travels;
    // halfSize: of the scene's box around the origin.
    AimShadows(std::span<const Caster> casters, std::span<const float> worth,
               const Vec3f& direction, const Vec3d& halfSize,
               float unaimedShare = AimMixture::kUnaimedShare);

    // False when the point has no density.
    bool sample(float uChoice, Vec2f u, Sample& sample) const;
    double pdfArea(const Vec3d& point) const;

    // Area of a caster's shadow, scene units squared.
    static double areaOf(const Caster& caster, const Vec3d& direction);

  private:
    struct Part {
        const Caster* caster;
        double area, share;
        std::uint32_t index;
        bool isBox;
    };
    static Part partOf(const Caster& caster, const Vec3d& direction);
    bool holds(const Part& part, const Vec3d& point) const;
    Vec3d pointIn(const Part& part, Vec2f u) const;
    // Of all casters but `leftOut`; and with what is unaimed.
    double pdfOfParts(const Vec3d& point, const Part* leftOut) const;
    double pdfOfOthers(const Vec3d& point, const Part* leftOut) const;

    Vec3d m_direction;
    BoxShadow m_scene;
    // Not initialised: that would take longer than aiming at a few casters.
    union Slot {
        Slot() {}
        Part part;
    };
    std::array<Slot, kMostCasters> m_slots;
    std::size_t m_count = 0;
    double m_unaimedShare = 1.0;
};

}  // namespace pm
