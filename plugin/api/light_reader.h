// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What parameters amount to together, beyond the range of each: lights, environments, cameras.
#pragma once

#include <string>

#include "integrator/scene/scene_description.h"
#include "plugin/api/parameter_reader.h"

namespace pm::plugin {

// All of these throw CallError: ARGUMENT for values outside their ranges, which the text names, or
// that don't go together; UNSUPPORTED for what this version does not render. owner: for the text.

// What its kind has; the other values are left alone.
void checkLight(LightSet& light, const std::string& owner);
void checkEnvironment(EnvironmentSet& environment, const std::string& owner);
void checkCamera(CameraSet& camera, const std::string& owner);

// Adds a light that was checked to the description.
void addLightTo(const LightSet& light, SceneDescription& description);

}  // namespace pm::plugin
