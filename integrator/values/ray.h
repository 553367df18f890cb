// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <limits>

#include "integrator/values/vec.h"

namespace pm {

// Who asks what a ray meets, and what a shape may be hidden from: bits, added up.
using Viewers = std::uint32_t;
inline constexpr Viewers kCameraRays = 1;      // from the camera, as far as they go straight on
inline constexpr Viewers kShadowRays = 2;      // between a surface and a light
inline constexpr Viewers kReflectionRays = 4;  // all others that leave a surface
inline constexpr Viewers kLightRays = 8;       // that look for lamps along a shadow ray's way
inline constexpr Viewers kAllRays = 15;

// A ray in the scene's own coordinates (its centre at the origin). The direction need not have unit
// length; distances are in units of its length.
struct Ray {
    Vec3f origin;
    Vec3f direction;
    float tMax = std::numeric_limits<float>::infinity();
    Viewers viewer = kReflectionRays;  // meets what is seen by one of them
    float time = 0.0f;                 // within the frame's shutter, in [0, 1]
};

// The primitive that a ray meets first. Where exactly it is met is computed again from the
// primitive.
struct RayHit {
    std::uint32_t shape = 0;      // in the order in which shapes were added
    std::uint32_t primitive = 0;  // triangle of that shape; 0 for spheres
    float t = 0.0f;
    bool isPane = false;  // see Surface; never set by the tracer
};

}  // namespace pm
