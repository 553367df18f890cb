// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <vector>

#include "integrator/photons/emission/aim_cone.h"
#include "integrator/scene/camera.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/frame/render_settings.h"
#include "integrator/values/cancel_check.h"

namespace pm {

// Balls that most of the rays go through by which the surfaces that the camera sees look at the
// sky: the windows of a room. None without an environment, in the open, where nearly all of the
// photons from afar enter anyway, or where the rays share no few narrow ways. A function of scene,
// camera and settings; works in parallel in the calling TBB arena. Throws Error(kCancelled) soon
// after cancel is set.
struct SkyOpenings {
    std::vector<Caster> balls;
    // Of each of SkyParts: the rays that saw it, of all.
    std::vector<float> seenShare;
};
SkyOpenings findSkyOpenings(const Scene& scene, const Camera& camera,
                            const RenderSettings& settings, const CancelCheck& cancel);

}  // namespace pm
