// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/transport/frame/render_settings.h"
#include "integrator/transport/frame/transport_plan.h"

namespace pm {

class Scene;

// Processor seconds of a pass by a plan, the pilots' share included: rays by how many triangles
// there are, sites by whether patches serve them, camera samples by whether their paths divide or
// look along broad lobes. To be told, and for progress: no picture depends on it.
// pm_bench_plan_time holds it against what passes take.
double secondsOfPass(const Scene& scene, const RenderSettings& settings, const Plan& plan);

}  // namespace pm
