// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>
#include <tuple>
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

// A table for each kind of shape that is no mesh or cage, in the order of Shape.
template <typename Kinds>
struct ShapeTablesOf;
template <typename Mesh, typename Limit, typename... Curved>
struct ShapeTablesOf<std::variant<Mesh, Limit, Curved...>> {
    using Type = std::tuple<std::span<const Parameter<Curved>>...>;
};
using ShapeTables = ShapeTablesOf<Shape>::Type;

// The table of one of those kinds.
template <typename Curved>
std::span<const Parameter<Curved>> rowsOf(const ShapeTables& tables) {
    return std::get<std::span<const Parameter<Curved>>>(tables);
}

// A table for each thing that a host describes by a struct. The rows must outlive it.
struct SceneTables {
    std::span<const MaterialParameter> materials;
    std::span<const LightParameter> lights;
    std::span<const EnvironmentParameter> environments;
    std::span<const CameraParameter> cameras;
    std::span<const InstanceParameter> instances;
    ShapeTables shapes;
};

}  // namespace pm::plugin
