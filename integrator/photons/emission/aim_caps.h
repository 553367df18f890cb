// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "integrator/photons/emission/aim_mixture.h"
#include "integrator/scene/scene.h"
#include "integrator/values/vec.h"

namespace pm {

// Normals of a sphere light's points, mostly in the caps from which casters are seen: those whose
// cosine to the caster's direction is above t. Within a cap the density grows with that, as what is
// seen of the caster does. The rest is even.
class AimCaps {
  public:
    // casters: at most kMostCasters. worth: of each caster, > 0.
    AimCaps(const SphereShape& sphere, std::span<const Caster> casters,
            std::span<const float> worth);

    // Unit normal; its density over the unit sphere. uChoice: leaves what is left of it, in [0, 1).
    Vec3f sample(float& uChoice, Vec2f u, float& pdfSolidAngle) const;
    // The density with which sample() finds a normal.
    float pdfSolidAngle(const Vec3f& normal) const;

  private:
    struct Cap {
        Vec3f axis;
        float t, share;
        float density(float cosine) const;
    };
    std::array<Cap, kMostCasters> m_caps;
    std::size_t m_count = 0;
    float m_evenShare = 1.0f;
};

}  // namespace pm
