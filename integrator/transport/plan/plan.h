// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/transport/frame/transport_plan.h"

namespace pm {

class Scene;

// Pure: depends on its arguments only.
Plan makePlan(const Scene& scene, const RenderSettings& settings);

}  // namespace pm
