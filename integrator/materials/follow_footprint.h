// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/materials/bsdf.h"
#include "integrator/shapes/ray_footprint.h"

namespace pm {

// A footprint at a surface becomes that of the ray onwards by a sampled direction. in: of the ray
// that led there.
void followFootprint(const Vec3f& in, const Surface& surface, const Bsdf& bsdf,
                     const BsdfSample& sample, RayFootprint& footprint);

}  // namespace pm
