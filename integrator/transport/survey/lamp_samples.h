// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/scene/camera.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/frame/render_settings.h"
#include "integrator/transport/frame/transport_plan.h"
#include "integrator/values/cancel_check.h"

namespace pm {

// How many lamp samples a camera sample is worth (see PhotonIntegrator): a power of two, 1 to
// kMostLampSamples. A pilot at places spread over the frame finds how noisy they are; the more, and
// the dearer the rest of a camera sample by the plan's estimate, the more of them pay. It enters no
// picture. A function of scene, settings and seed, not of crop, passes or threads. The lights must
// have learnt already; works in parallel in the calling TBB arena. Throws Error(kCancelled) soon
// after cancel is set.
std::uint32_t findLampSamples(const Scene& scene, const LightSampler& lights, const Camera& camera,
                              const RenderSettings& settings, const Plan& plan,
                              const CancelCheck& cancel = {});

constexpr std::uint32_t kMostLampSamples = 16;

}  // namespace pm
