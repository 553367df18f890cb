// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <limits>

#include "integrator/values/vec.h"

namespace pm {

// A ray in the scene's own coordinates (its centre at the origin). The direction need not have unit
// length; distances are in units of its length.
struct Ray {
    Vec3f origin;
    Vec3f direction;
    float tMax = std::numeric_limits<float>::infinity();
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
