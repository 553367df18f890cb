// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <optional>

#include "integrator/lights/light_place.h"
#include "integrator/lights/surface_light.h"

namespace pm {

// A triangle that shines. Nearly all of its samples go by its LampTriangle, see there; by this the
// textured ones and the huge ones.
struct TriangleLight : SurfaceLight {
    static constexpr LightPlace kPlace = LightPlace::kOnSurface;

    bool sample(const Scene& scene, const Surface& from, Vec2f u, float probability,
                LightSample& sample) const;
    float pdfSolidAngle(const Scene& scene, const Surface& from, const Vec3f& direction,
                        const Surface& onLight, float probability) const;
    LightExtent extent(const Scene& scene) const;
    LightBall ball(const Scene& scene) const;
    static std::optional<SphereShape> wholeSphere(const Scene&) { return std::nullopt; }
};

}  // namespace pm
