// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>
#include <vector>

#include "integrator/materials/material_description.h"
#include "integrator/photons/emission/aim_cone.h"
#include "integrator/scene/scene.h"
#include "integrator/values/cancel_check.h"

namespace pm {

// Casters that together hold every surface of the scene that casts caustics, at most kMostFound:
// as many as make the solid angle they fill, seen from the viewpoints, clearly smaller. Empty when
// nothing casts. Time: about that of sorting the casting triangles by place. Throws
// Error(kCancelled) soon after cancel is set.
std::vector<Caster> findCasters(const Scene& scene, std::span<const EmissionPoint> viewpoints,
                                const CancelCheck& cancel = {});

}  // namespace pm
