// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <optional>

#include "integrator/lights/light_place.h"
#include "integrator/lights/surface_light.h"

namespace pm {

// A sphere that shines. Its points are chosen uniformly over the solid angle that it fills (source:
// Shirley & Wang 1994); where a texture shows mostly some part of it, half of them by what it
// shows.
struct SphereLight : SurfaceLight {
    static constexpr LightPlace kPlace = LightPlace::kOnSurface;

    bool sample(const Scene& scene, const Surface& from, Vec2f u, float probability,
                LightSample& sample) const;
    float pdfSolidAngle(const Scene& scene, const Surface& from, const Vec3f& direction,
                        const Surface& onLight, float probability) const;
    LightExtent extent(const Scene& scene) const;
    LightBall ball(const Scene& scene) const;
    std::optional<SphereShape> wholeSphere(const Scene& scene) const {
        return sphereOf(scene, *this);
    }

  private:
    bool sampleByTexture(const Scene& scene, const Surface& from, Vec2f u, float probability,
                         LightSample& sample) const;
    // Of all of a textured sphere's strategies; without the light's probability.
    float pdfOfTextured(const Scene& scene, const Surface& from, const Vec3f& direction,
                        const Surface& point) const;
};

}  // namespace pm
