// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/api/light_reader.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "plugin/api/transform_reader.h"
#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

Rgb checkedColour(const float (&values)[3], const char* member, const char* unit) {
    for (const float value : values)
        if (!(value >= 0.0f) || !std::isfinite(value))
            throw argumentError(
                fmt::format("{} is {}; it must be 0 or more and finite ({})", member, value, unit));
    return {values[0], values[1], values[2]};
}

Vec3d column(const Transform& m, std::size_t i) {
    return {m[i], m[4 + i], m[8 + i]};
}

// Angles and directions mean nothing under a transform that stretches or shears.
Transform readRotation(const double* transforms, std::uint64_t count, const char* what) {
    const Transform m = readTransform(transforms, count, what);
    constexpr double kTolerance = 1e-4;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = i; j < 3; ++j) {
            const double product = dot(column(m, i), column(m, j));
            if (!(std::abs(product - (i == j ? 1 : 0)) <= kTolerance))
                throw argumentError(fmt::format(
                    "{}: its transform must be a rotation and a translation; of columns {} and {} "
                    "the product is {}, not {}",
                    what, i, j, product, i == j ? 1 : 0));
        }
    return m;
}

Vec3d position(const Transform& m) {
    return {m[3], m[7], m[11]};
}

SpotLightDescription readSpot(const PmrLightDesc& desc) {
    const Transform m = readRotation(desc.transforms, desc.transformCount, "PmrLightDesc");
    SpotLightDescription spot;
    spot.position = position(m);
    spot.direction = -column(m, 2);
    spot.intensity = checkedColour(desc.emission, "PmrLightDesc: emission", "W/sr");
    // As floats have pi, the whole sphere is allowed.
    if (!(desc.coneAngle > 0.0f && desc.coneAngle <= std::numbers::pi_v<float>))
        throw argumentError(fmt::format(
            "PmrLightDesc: coneAngle is {}; it must be above 0 and at most pi (radians)",
            desc.coneAngle));
    if (!(desc.coneFalloff >= 0.0f && desc.coneFalloff <= desc.coneAngle))
        throw argumentError(fmt::format(
            "PmrLightDesc: coneFalloff is {}; it must be 0 to coneAngle, which is {} (radians)",
            desc.coneFalloff, desc.coneAngle));
    spot.coneAngle = static_cast<double>(desc.coneAngle);
    spot.coneFalloff = static_cast<double>(desc.coneFalloff);
    spot.name = desc.name == nullptr ? "" : desc.name;
    return spot;
}

DirectionalLightDescription readDirectional(const PmrLightDesc& desc) {
    const Transform m = readRotation(desc.transforms, desc.transformCount, "PmrLightDesc");
    DirectionalLightDescription light;
    light.direction = -column(m, 2);
    light.irradiance = checkedColour(desc.emission, "PmrLightDesc: emission", "W/m^2");
    if (!(desc.angularRadius >= 0.0f && desc.angularRadius <= std::numbers::pi_v<float> / 2))
        throw argumentError(
            fmt::format("PmrLightDesc: angularRadius is {}; it must be 0 to pi/2 (radians)",
                        desc.angularRadius));
    light.angularRadius = static_cast<double>(desc.angularRadius);
    light.name = desc.name == nullptr ? "" : desc.name;
    return light;
}

PointLightDescription readPoint(const PmrLightDesc& desc) {
    PointLightDescription light;
    light.position = position(readTransform(desc.transforms, desc.transformCount, "PmrLightDesc"));
    light.intensity = checkedColour(desc.emission, "PmrLightDesc: emission", "W/sr");
    light.name = desc.name == nullptr ? "" : desc.name;
    return light;
}

}  // namespace

void readLight(const PmrLightDesc& desc, SceneDescription& description) {
    switch (desc.kind) {
        case PMR_LIGHT_POINT:
            description.lights.push_back(readPoint(desc));
            return;
        case PMR_LIGHT_SPOT:
            description.lights.push_back(readSpot(desc));
            return;
        case PMR_LIGHT_DIRECTIONAL:
            description.lights.push_back(readDirectional(desc));
            return;
        default:
            throw argumentError(fmt::format(
                "PmrLightDesc: kind is {}; it must be 0 to 2 (PMR_LIGHT_*)", desc.kind));
    }
}

EnvironmentDescription readEnvironment(const PmrEnvironmentDesc& desc) {
    EnvironmentDescription environment;
    environment.radiance =
        checkedColour(desc.radiance, "PmrEnvironmentDesc: radiance", "W m^-2 sr^-1");
    if (desc.reserved != 0.0f) throw argumentError("PmrEnvironmentDesc: reserved must be 0");
    environment.toWorld = readRotation(desc.transforms, desc.transformCount, "PmrEnvironmentDesc");
    return environment;
}

}  // namespace pm::plugin
