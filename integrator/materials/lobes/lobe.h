// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

// The roles that the parts of a BSDF have in light paths; of a mixture several lobes may have one.
// Each path is told apart by the lobes it went through, so lobes are sampled one at a time, never
// as a mixture. Which model stands in a role is the business of its own file in this folder.
enum class Lobe : std::uint8_t {
    kDiffuse,     // much like Lambertian: irradiance is all that need be known of what it reflects
    kGlossy,      // around one direction, narrow enough to cast caustics
    kWide,        // the same, and wide enough to receive them as a diffuse one does
    kBroad,       // one that is not: for the classes of paths much like the diffuse one
    kReflection,  // mirror, and the reflected part of a dielectric (delta)
    kRefraction,  // delta
    // Transparency: passes as if nothing were there (delta). It is no event of a path: changes no
    // class of paths and stands in no density. Shadow rays go by it as well: Scene::transmittance.
    kStraight,
};
inline constexpr std::size_t kLobeCount = 7;

// Around a direction, of three widths.
inline constexpr std::array kShinyLobes{Lobe::kGlossy, Lobe::kWide, Lobe::kBroad};
constexpr bool isWide(Lobe lobe) {
    return lobe == Lobe::kWide || lobe == Lobe::kBroad;
}
constexpr bool isDelta(Lobe lobe) {
    return lobe == Lobe::kReflection || lobe == Lobe::kRefraction || lobe == Lobe::kStraight;
}

// What travels along the path: radiance from the camera backwards, or photons from a light. They
// differ in the factor eta^2 of refraction and in the correction for shading normals.
// Source: Veach 1997, sections 5.2 and 5.3.
enum class Transport : std::uint8_t { kRadiance, kPhotons };

// In [0, 1)^3: what a lobe takes its direction by, and, where it has two ways to send light, which.
struct LobeNumbers : Vec2f {
    float way = 0.0f;

    constexpr LobeNumbers() = default;
    constexpr LobeNumbers(Vec2f direction, float way_) : Vec2f(direction), way(way_) {}
};

struct BsdfSample {
    Vec3f direction;             // unit, away from the surface
    Rgb weight;                  // f |cos| / pdf, the lobe's choice included
    float pdfSolidAngle = 0.0f;  // sr^-1, the lobe's choice included; of a delta lobe its
                                 // choice's probability
    float etaSquared = 1.0f;     // of the medium that it leads into over the one it came from, by
                                 // their indices; 1 where it stays in one
    Lobe lobe = Lobe::kDiffuse;
};

}  // namespace pm
