// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <vector>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/scene/camera.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/frame/render_settings.h"
#include "integrator/values/cancel_check.h"

namespace pm {

// Places where a render will ask for direct light, for LightSampler::learn: spread over the frame
// as its camera samples will be, and along their paths as far as the integrator follows them. A
// function of scene and settings; works in parallel in the calling TBB arena. Throws
// Error(kCancelled) soon after cancel is set.
std::vector<LitPlace> findLitPlaces(const Scene& scene, const Camera& camera,
                                    const RenderSettings& settings, const CancelCheck& cancel = {});

}  // namespace pm
