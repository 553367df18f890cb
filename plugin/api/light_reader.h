// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/scene/scene_description.h"
#include "plugin/include/pm_plugin.h"

namespace pm::plugin {

// Adds a host's light to the description. Throws CallError: ARGUMENT for values outside their
// ranges, which the text names.
void readLight(const PmrLightDesc& desc, SceneDescription& description);

// The environment but for its texture, which stays kNoTexture. Errors as above.
EnvironmentDescription readEnvironment(const PmrEnvironmentDesc& desc);

}  // namespace pm::plugin
