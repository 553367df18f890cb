// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <array>
#include <cstddef>
#include <numbers>

#include "plugin/api/parameter_tables.h"
#include "plugin/include/pm_plugin.h"
#include "plugin/parameters/place.h"

namespace pm::plugin {

namespace {

using Kind = StructPlace::Kind;
using Type = ParameterType;
using Point = PointLightDescription;
using Spot = SpotLightDescription;
using Directional = DirectionalLightDescription;

constexpr std::uint32_t kSpots = 1u << PMR_LIGHT_SPOT;
constexpr std::uint32_t kDirectionals = 1u << PMR_LIGHT_DIRECTIONAL;
// As floats have pi, the whole sphere is allowed.
constexpr double kPi = static_cast<double>(std::numbers::pi_v<float>);

Vec3d translation(const ParameterValue& transform) {
    return {transform.numbers.at(3), transform.numbers.at(7), transform.numbers.at(11)};
}

// Light travels along -z.
Vec3d backwards(const ParameterValue& transform) {
    return -Vec3d{transform.numbers.at(2), transform.numbers.at(6), transform.numbers.at(10)};
}

constexpr Place<Point> kPlaceOfPoint = {
    [](Point& light, const ParameterValue& value, std::int32_t) {
        light.position = translation(value);
    },
    [](Hasher& hasher, const Point& light) { hasher.add(light.position); }};
constexpr Place<Spot> kPlaceOfSpot = {[](Spot& light, const ParameterValue& value, std::int32_t) {
                                          light.position = translation(value);
                                          light.direction = backwards(value);
                                      },
                                      [](Hasher& hasher, const Spot& light) {
                                          hasher.add(light.position);
                                          hasher.add(light.direction);
                                      }};
constexpr Place<Directional> kPlaceOfDirectional = {
    [](Directional& light, const ParameterValue& value, std::int32_t) {
        light.direction = backwards(value);
    },
    [](Hasher& hasher, const Directional& light) { hasher.add(light.direction); }};

constexpr std::array kLightRows = {
    // Identities tell kinds apart by themselves.
    LightParameter{{.name = "kind",
                    .help = "point: in all directions; spot: inside a cone along -z; directional: "
                            "along -z, from infinitely far.",
                    .type = Type::kChoice,
                    .maximum = 2,
                    .defaultText = "point",
                    .choices = "point,spot,directional"},
                   {Kind::kInt32, offsetof(PmrLightDesc, kind)},
                   {}},
    LightParameter{{.name = "transforms",
                    .help = "3 x 4 numbers, row-major, light to world: a rotation and a "
                            "translation, of a point light the translation counts.",
                    .count = 12,
                    .minimum = -kNoEnd,
                    .maximum = kNoEnd,
                    .defaultText = kIdentityText},
                   {Kind::kTransform, offsetof(PmrLightDesc, transforms)},
                   {kPlaceOfPoint, kPlaceOfSpot, kPlaceOfDirectional}},
    LightParameter{{.name = "emission",
                    .help = "Intensity, of directional lights irradiance of a surface that faces "
                            "them.",
                    .count = 3,
                    .unit = "W/sr; directional: W/m^2",
                    .maximum = kNoEnd,
                    .defaultText = "0 0 0"},
                   {Kind::kFloats, offsetof(PmrLightDesc, emission)},
                   {memberPlace<&Point::intensity>(), memberPlace<&Spot::intensity>(),
                    memberPlace<&Directional::irradiance>()}},
    LightParameter{{.name = "coneAngle",
                    .help = "Spot: half angle of the whole cone.",
                    .unit = "radians",
                    .maximum = kPi,
                    .excludesMinimum = true,
                    .defaultText = "0",
                    .kinds = kSpots},
                   {Kind::kFloats, offsetof(PmrLightDesc, coneAngle)},
                   {Place<Point>{}, memberPlace<&Spot::coneAngle>(), Place<Directional>{}}},
    LightParameter{{.name = "coneFalloff",
                    .help = "Spot: angle inside the cone over which the light fades, at most "
                            "coneAngle.",
                    .unit = "radians",
                    .maximum = kPi,
                    .defaultText = "0",
                    .kinds = kSpots},
                   {Kind::kFloats, offsetof(PmrLightDesc, coneFalloff)},
                   {Place<Point>{}, memberPlace<&Spot::coneFalloff>(), Place<Directional>{}}},
    LightParameter{{.name = "angularRadius",
                    .help = "Directional: half angle of the disc in the sky; below 1e-4 it shines "
                            "along one direction and isn't seen.",
                    .unit = "radians",
                    .maximum = kPi / 2,
                    .defaultText = "0",
                    .kinds = kDirectionals},
                   {Kind::kFloats, offsetof(PmrLightDesc, angularRadius)},
                   {Place<Point>{}, Place<Spot>{}, memberPlace<&Directional::angularRadius>()}},
    LightParameter{{.name = "id",
                    .help = "A number of the host's.",
                    .type = Type::kInteger,
                    .maximum = 4294967295.0,
                    .defaultText = "0",
                    .changesPixels = false},
                   {Kind::kUint32, offsetof(PmrLightDesc, id)},
                   {}},
    LightParameter{
        {.name = "name", .help = "For messages.", .type = Type::kText, .changesPixels = false},
        {Kind::kText, offsetof(PmrLightDesc, name)},
        {unseenPlace<&Point::name>(), unseenPlace<&Spot::name>(),
         unseenPlace<&Directional::name>()}},
};

using E = EnvironmentDescription;

constexpr std::array kEnvironmentRows = {
    EnvironmentParameter{{.name = "radiance",
                          .help = "Times the texture where there is one.",
                          .count = 3,
                          .unit = "W m^-2 sr^-1",
                          .maximum = kNoEnd,
                          .defaultText = "0 0 0"},
                         {Kind::kFloats, offsetof(PmrEnvironmentDesc, radiance)},
                         {memberPlace<&E::radiance>()}},
    EnvironmentParameter{{.name = "texture",
                          .help = "A latitude-longitude picture: its middle towards -z, its right "
                                  "half towards +x, its upper edge towards +y.",
                          .type = Type::kTexture},
                         {Kind::kTexture, offsetof(PmrEnvironmentDesc, texture)},
                         {texturePlace<&E::texture>()}},
    EnvironmentParameter{{.name = "transforms",
                          .help = "3 x 4 numbers, row-major, environment to world: a rotation.",
                          .count = 12,
                          .minimum = -kNoEnd,
                          .maximum = kNoEnd,
                          .defaultText = kIdentityText},
                         {Kind::kTransform, offsetof(PmrEnvironmentDesc, transforms)},
                         {memberPlace<&E::toWorld>()}},
};

}  // namespace

std::span<const LightParameter> lightParameters() {
    return kLightRows;
}

std::span<const EnvironmentParameter> environmentParameters() {
    return kEnvironmentRows;
}

}  // namespace pm::plugin
