// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/scene/camera.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/frame/render_settings.h"
#include "integrator/transport/gather/final_gather.h"
#include "integrator/transport/gather/gather_guide.h"
#include "integrator/values/cancel_check.h"
#include "integrator/values/error_scale.h"

namespace pm {

// How much the gather rays of one point differ: the variance of the radiance that one of them
// brings to the eye over (r^2 + scale's offset), r what the eye sees there of direct and gathered
// light; mean over places spread over the frame and over the channels. Dimensionless; 0 where
// nothing is gathered. A function of its arguments and the frame; works in parallel in the calling
// TBB arena. Throws Error(kCancelled) soon after cancel is set.
double gatherSpread(const Scene& scene, const Camera& camera, const LightSampler& lights,
                    const GatherEnds& ends, const RenderSettings& settings, const ErrorScale& scale,
                    const CancelCheck& cancel = {});

// The same of rays by the cosine and by a guide, each as well spread over the directions as those
// of a gather point: 32 times the variance of the mean of 32.
struct GatherRivals {
    double byCosine = 0, byGuide = 0;
};
GatherRivals gatherRivals(const Scene& scene, const Camera& camera, const LightSampler& lights,
                          const GatherEnds& ends, const GatherGuide& guide,
                          const RenderSettings& settings, const ErrorScale& scale,
                          const CancelCheck& cancel = {});

// Rays of a gather point that pay at that spread, where `rays` are planned: half of those, or
// those, or twice or four times as many.
std::uint32_t gatherRaysFor(double spread, std::uint32_t rays);

}  // namespace pm
