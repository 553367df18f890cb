// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <array>
#include <cstddef>

#include "plugin/api/parameter_tables.h"
#include "plugin/include/pm_plugin.h"
#include "plugin/parameters/place.h"

namespace pm::plugin {

namespace {

using Kind = StructPlace::Kind;

constexpr std::array kSphereRows = {
    SphereParameter{{.name = "centre",
                     .help = "In object space.",
                     .count = 3,
                     .unit = "scene units",
                     .minimum = -kMaxCoordinate,
                     .maximum = kMaxCoordinate,
                     .defaultText = "0 0 0"},
                    {Kind::kDoubles, offsetof(PmrSphereDesc, centre)},
                    {memberPlace<&SphereShape::centre>()}},
    SphereParameter{{.name = "radius",
                     .help = "In object space.",
                     .unit = "scene units",
                     .maximum = kMaxCoordinate,
                     .excludesMinimum = true,
                     .defaultText = "0"},
                    {Kind::kDoubles, offsetof(PmrSphereDesc, radius)},
                    {memberPlace<&SphereShape::radius>()}},
};

}  // namespace

std::span<const SphereParameter> sphereParameters() {
    return kSphereRows;
}

}  // namespace pm::plugin
