// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Instances and cameras.
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
using I = InstanceDescription;
using C = CameraDescription;

constexpr std::uint32_t kAllViewers =
    PMR_HIDDEN_FROM_CAMERA | PMR_HIDDEN_FROM_SHADOW | PMR_HIDDEN_FROM_REFLECTION;

// Nothing where it is hidden from none: scenes without keep the checksums that they have had.
constexpr Place<I> kHiddenFrom = {memberPlace<&I::hiddenFrom>().put,
                                  [](Hasher& hasher, const I& instance) {
                                      if (instance.hiddenFrom != 0) hasher.add(instance.hiddenFrom);
                                  }};
// Likewise.
constexpr Place<I> kTessellationRate = {memberPlace<&I::tessellationRate>().put,
                                        [](Hasher& hasher, const I& instance) {
                                            if (instance.tessellationRate == 0) return;
                                            hasher.add("tessellationRate");
                                            hasher.add(instance.tessellationRate);
                                        }};
// The host's handles have become numbers of the scene's materials.
constexpr Place<I> kMaterials = {
    nullptr, [](Hasher& hasher, const I& instance) { hashValue(hasher, instance.materials); }};

constexpr std::array kInstanceRows = {
    InstanceParameter{{.name = "transforms",
                       .help = "3 x 4 numbers, row-major, object to world.",
                       .count = 12,
                       .minimum = -kNoEnd,
                       .maximum = kNoEnd,
                       .defaultText = kIdentityText},
                      {Kind::kTransform, offsetof(PmrInstanceDesc, transforms)},
                      {memberPlace<&I::transform>()}},
    InstanceParameter{
        {.name = "materials", .help = "One for each slot of the mesh.", .type = Type::kObjects},
        {},
        {kMaterials}},
    InstanceParameter{{.name = "hiddenFrom",
                       .help = "What does not see it, added up: 1 the camera, 2 shadow rays, 4 "
                               "reflections and photons.",
                       .type = Type::kInteger,
                       .maximum = kAllViewers,
                       .defaultText = "0"},
                      {Kind::kUint32, offsetof(PmrInstanceDesc, hiddenFrom)},
                      {kHiddenFrom}},
    InstanceParameter{
        {.name = "tessellation",
         .help =
             "When a cage is cut into triangles: onDemand each part of it where a ray meets it, "
             "whole before any ray; auto: on demand what is displaced.",
         .type = Type::kChoice,
         .maximum = 2,
         .defaultText = "auto",
         .choices = "auto,onDemand,whole",
         .changesPixels = false,  // the shape that it chooses is hashed
         .isLater = true},
        {},
        {unseenPlace<&I::tessellation>()}},
    InstanceParameter{{.name = "tessellationRate",
                       .help = "Of a cage cut on demand: pieces of each of its edges; 0: by its "
                               "place in the picture.",
                       .type = Type::kInteger,
                       .maximum = 1024,
                       .defaultText = "0",
                       .isLater = true},
                      {},
                      {kTessellationRate}},
    InstanceParameter{{.name = "id",
                       .help = "A number of the host's.",
                       .type = Type::kInteger,
                       .maximum = 4294967295.0,
                       .defaultText = "0",
                       .changesPixels = false},
                      {Kind::kUint32, offsetof(PmrInstanceDesc, id)},
                      {unseenPlace<&I::id>()}},
    InstanceParameter{
        {.name = "name", .help = "For messages.", .type = Type::kText, .changesPixels = false},
        {Kind::kText, offsetof(PmrInstanceDesc, name)},
        {unseenPlace<&I::name>()}},
};

constexpr std::uint32_t kPerspective = 1u << PMR_CAMERA_PERSPECTIVE;
constexpr std::uint32_t kOrthographic = 1u << PMR_CAMERA_ORTHOGRAPHIC;

constexpr std::array kCameraRows = {
    CameraParameter{{.name = "kind",
                     .help = "This version renders perspective cameras only.",
                     .type = Type::kChoice,
                     .maximum = 2,
                     .defaultText = "perspective",
                     .choices = "perspective,orthographic,panorama",
                     .changesPixels = false},
                    {Kind::kInt32, offsetof(PmrCameraDesc, kind)},
                    {unseenPlace<&C::kind>()}},
    CameraParameter{{.name = "transforms",
                     .help = "3 x 4 numbers, row-major, camera to world; it looks along -z, +y up, "
                             "+x right.",
                     .count = 12,
                     .minimum = -kNoEnd,
                     .maximum = kNoEnd,
                     .defaultText = kIdentityText},
                    {Kind::kTransform, offsetof(PmrCameraDesc, transforms)},
                    {memberPlace<&C::cameraToWorld>()}},
    CameraParameter{{.name = "fieldOfView",
                     .help = "Perspective: vertical.",
                     .unit = "radians",
                     .maximum = std::numbers::pi,
                     .excludesMinimum = true,
                     .excludesMaximum = true,
                     .defaultText = "0",
                     .kinds = kPerspective},
                    {Kind::kDoubles, offsetof(PmrCameraDesc, fieldOfView)},
                    {memberPlace<&C::verticalFieldOfView>()}},
    CameraParameter{{.name = "height",
                     .help = "Orthographic: of what is seen. Not rendered by this version.",
                     .unit = "scene units",
                     .maximum = kNoEnd,
                     .excludesMinimum = true,
                     .defaultText = "0",
                     .kinds = kOrthographic,
                     .changesPixels = false},
                    {Kind::kDoubles, offsetof(PmrCameraDesc, height)},
                    {}},
    CameraParameter{{.name = "lensRadius",
                     .help = "Depth of field; 0 = pinhole, which is all that this version renders.",
                     .unit = "scene units",
                     .maximum = kNoEnd,
                     .defaultText = "0",
                     .changesPixels = false},
                    {Kind::kDoubles, offsetof(PmrCameraDesc, lensRadius)},
                    {}},
    CameraParameter{{.name = "focusDistance",
                     .help = "With a lens: where pictures are sharp. Not rendered by this version.",
                     .unit = "scene units",
                     .maximum = kNoEnd,
                     .defaultText = "0",
                     .kinds = 0,
                     .changesPixels = false},
                    {Kind::kDoubles, offsetof(PmrCameraDesc, focusDistance)},
                    {}},
    CameraParameter{{.name = "pixelAspect",
                     .help = "Width of a pixel over its height; 0 = 1.",
                     .maximum = kNoEnd,
                     .excludesMinimum = true,
                     .defaultText = "1",
                     .zeroMeans = 1},
                    {Kind::kDoubles, offsetof(PmrCameraDesc, pixelAspect)},
                    {memberPlace<&C::pixelAspect>()}},
};

}  // namespace

std::span<const InstanceParameter> instanceParameters() {
    return kInstanceRows;
}

std::span<const CameraParameter> cameraParameters() {
    return kCameraRows;
}

SceneTables sceneTables() {
    return {materialParameters(), lightParameters(),    environmentParameters(),
            cameraParameters(),   instanceParameters(), {sphereParameters()}};
}

}  // namespace pm::plugin
