// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>
#include <variant>

#include "integrator/scene/scene_description.h"
#include "plugin/parameters/parameter.h"

namespace pm::plugin {

// A row of objects of several kinds.
template <typename Kinds>
struct ParameterOf;
template <typename... Descriptions>
struct ParameterOf<std::variant<Descriptions...>> {
    using Type = Parameter<Descriptions...>;
};

using MaterialParameter = Parameter<MaterialDescription>;
using LightParameter = ParameterOf<LightDescription>::Type;
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
