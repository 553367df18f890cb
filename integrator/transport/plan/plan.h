// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>

#include "integrator/transport/frame/transport_plan.h"

namespace pm {

class Scene;

// Pure: depends on its arguments only. Throws Error(kCancelled) soon after `cancelled` is set.
Plan makePlan(const Scene& scene, const RenderSettings& settings,
              const std::atomic<bool>& cancelled);
// The same, to its end.
Plan makePlan(const Scene& scene, const RenderSettings& settings);

}  // namespace pm
