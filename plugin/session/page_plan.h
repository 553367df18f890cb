// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/transport/plan/plan.h"
#include "plugin/session/memory_plan.h"
#include "plugin/session/setting_values.h"

namespace pm::plugin {

// Puts the photon maps of a plan into pages where a setting says so, or where the need is above the
// limit and pages of some use bring it below. pointBytes: of gather points that are held at once,
// of one pass.
void planPages(const Plan& plan, const SettingValues& values, std::uint64_t pointBytes,
               MemoryPlan& memory);

}  // namespace pm::plugin
