// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/scene/scene.h"
#include "integrator/transport/frame/render_settings.h"
#include "integrator/values/cancel_check.h"
#include "integrator/values/error_scale.h"

namespace pm {

// The whole number of stops that brings the log-average luminance of the picture to a middle grey
// of 0.18, metered as cameras do: what is covered, shows no lamp and reflects some light, and no
// brighter than leaves all but one in fifty below 2. From a few thousand paths at most, whose
// random numbers depend on nothing: so it is a function of scene, camera and the frame's sides, not
// of seed, crop or threads, and a scene 2^k times as bright has k less. 0 where it is within
// +-kNeutralStops, and where no light is seen. It changes no sample, only what they are taken for.
// Works in parallel in the calling TBB arena. Throws Error(kCancelled) soon after cancel is set,
// and what Camera does.
ErrorScale findErrorScale(const Scene& scene, const RenderSettings& settings,
                          const CancelCheck& cancel = {});

// The same before pictures that are near to it are told apart: within +-ErrorScale::kMostStops.
std::int32_t stopsToMiddleGrey(const Scene& scene, const RenderSettings& settings,
                               const CancelCheck& cancel = {});

constexpr std::int32_t kNeutralStops = 3;

}  // namespace pm
