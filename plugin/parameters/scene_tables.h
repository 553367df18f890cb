// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>

#include "integrator/scene/scene_description.h"
#include "plugin/parameters/parameter.h"

namespace pm::plugin {

using MaterialParameter = Parameter<MaterialDescription>;
using LightParameter =
    Parameter<PointLightDescription, SpotLightDescription, DirectionalLightDescription>;
using EnvironmentParameter = Parameter<EnvironmentDescription>;
using CameraParameter = Parameter<CameraDescription>;
using InstanceParameter = Parameter<InstanceDescription>;
using SphereParameter = Parameter<SphereShape>;

// A table for each thing that a host describes by a struct. The rows must outlive it.
struct SceneTables {
    std::span<const MaterialParameter> materials;
    std::span<const LightParameter> lights;
    std::span<const EnvironmentParameter> environments;
    std::span<const CameraParameter> cameras;
    std::span<const InstanceParameter> instances;
    std::span<const SphereParameter> spheres;
};

}  // namespace pm::plugin
