// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The tables of what hosts describe, a row a member of the interface's structs; then, what came
// later. The order is that in which identities take them, so new rows go to the ends.
#pragma once

#include <span>

#include "plugin/parameters/scene_tables.h"

namespace pm::plugin {

std::span<const MaterialParameter> materialParameters();
std::span<const LightParameter> lightParameters();
std::span<const EnvironmentParameter> environmentParameters();
std::span<const CameraParameter> cameraParameters();
std::span<const InstanceParameter> instanceParameters();
std::span<const SphereParameter> sphereParameters();

// All of them. A new kind of shape has its table in a file of its own, declared above and added to
// the end of SceneTables::shapes.
SceneTables sceneTables();

}  // namespace pm::plugin
