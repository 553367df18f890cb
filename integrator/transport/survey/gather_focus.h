// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/photons/emission/focus.h"
#include "integrator/scene/camera.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/frame/render_settings.h"
#include "integrator/values/cancel_check.h"

namespace pm {

// Where the gather rays of a render end, weighed by what light there is worth to the camera: the
// ball that holds nine tenths of the nearest quarter of their ends, where the scene reaches far
// beyond it; otherwise, everywhere. A function of scene, camera and settings;
// works in parallel in the calling TBB arena. Throws Error(kCancelled) soon after cancel is set.
Focus findGatherFocus(const Scene& scene, const Camera& camera, const RenderSettings& settings,
                      const CancelCheck& cancel);

// Likewise of what the camera sees itself: where its paths find the first diffuse surface, the
// nearest quarter by depth.
Focus findSeenFocus(const Scene& scene, const Camera& camera, const RenderSettings& settings,
                    const CancelCheck& cancel);

}  // namespace pm
