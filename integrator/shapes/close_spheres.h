// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <vector>

#include "integrator/values/vec.h"

namespace pm {

// A sphere of glass, world, about the scene's centre.
struct GlassSphere {
    Vec3d centre;
    double radius = 0;
};

// How many of them have another about the same centre whose surface is closer than rays can tell
// apart, and not the same: light that goes through both is lost or made.
std::size_t countCloseSpheres(std::vector<GlassSphere> spheres);

}  // namespace pm
