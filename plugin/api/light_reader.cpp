// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/api/light_reader.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <variant>

#include "integrator/cameras/camera_model.h"
#include "plugin/api/transform_reader.h"
#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

Vec3d column(const Transform& m, std::size_t i) {
    return {m[i], m[4 + i], m[8 + i]};
}

// Angles and directions mean nothing under a transform that stretches or shears.
void checkRotation(const ParameterValue& transform, const std::string& owner) {
    const Transform m = readTransform(transform.numbers.data(), 1, owner.c_str());
    constexpr double kTolerance = 1e-4;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = i; j < 3; ++j) {
            const double product = dot(column(m, i), column(m, j));
            if (!(std::abs(product - (i == j ? 1 : 0)) <= kTolerance))
                throw argumentError(fmt::format(
                    "{}: its transform must be a rotation and a translation; of columns {} and {} "
                    "the product is {}, not {}",
                    owner, i, j, product, i == j ? 1 : 0));
        }
}

std::int32_t kindOf(const auto& set) {
    return static_cast<std::int32_t>(set.number("kind"));
}

template <typename Light>
Light made(const LightSet& values) {
    Light light;
    values.putInto(light);
    return light;
}

// The kind first: it says what else means something.
template <typename Set>
void checkKinds(Set& set, const std::string& owner) {
    set.set("kind", set.value("kind"), owner);
    set.check(static_cast<std::uint32_t>(kindOf(set)), owner);
}

// PMR_LIGHT_* are the places of the kinds in their list.
template <std::size_t i = 0>
void addKind(const LightSet& light, std::size_t kind, SceneDescription& description) {
    if constexpr (i < std::variant_size_v<LightDescription>) {
        if (kind == i)
            description.lights.push_back(
                made<std::variant_alternative_t<i, LightDescription>>(light));
        else
            addKind<i + 1>(light, kind, description);
    }
}

}  // namespace

void checkLight(LightSet& light, const std::string& owner) {
    checkKinds(light, owner);
    if (kindOf(light) == PMR_LIGHT_POINT)
        readTransform(light.value("transforms").numbers.data(), 1, owner.c_str());
    else
        checkRotation(light.value("transforms"), owner);
    const double angle = light.number("coneAngle"), falloff = light.number("coneFalloff");
    if (kindOf(light) == PMR_LIGHT_SPOT && falloff > angle)
        throw argumentError(fmt::format(
            "{}: coneFalloff is {:g}; it must be 0 to coneAngle, which is {:g} (radians)", owner,
            falloff, angle));
}

void checkEnvironment(EnvironmentSet& environment, const std::string& owner) {
    environment.check(0, owner);
    checkRotation(environment.value("transforms"), owner);
}

void checkCamera(CameraSet& camera, const std::string& owner) {
    camera.set("kind", camera.value("kind"), owner);
    if (static_cast<std::size_t>(kindOf(camera)) >= std::variant_size_v<CameraModel>)
        throw CallError(
            CallStatus::kUnsupported,
            fmt::format("{}: this version renders perspective cameras only, not {} ones", owner,
                        kindOf(camera) == PMR_CAMERA_ORTHOGRAPHIC ? "orthographic" : "panorama"));
    checkKinds(camera, owner);
    if (camera.number("lensRadius") > 0)
        throw CallError(
            CallStatus::kUnsupported,
            fmt::format("{}: this version renders pinhole cameras only (lensRadius 0)", owner));
    readTransform(camera.value("transforms").numbers.data(), 1, owner.c_str());
}

void addLightTo(const LightSet& light, SceneDescription& description) {
    addKind(light, static_cast<std::size_t>(kindOf(light)), description);
}

}  // namespace pm::plugin
