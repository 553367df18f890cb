// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

namespace pm {

struct Plan;
struct RenderSettings;

// The plan's memory, from the photons and landings that are planned.
void estimateMemory(const RenderSettings& settings, Plan& plan);

}  // namespace pm
