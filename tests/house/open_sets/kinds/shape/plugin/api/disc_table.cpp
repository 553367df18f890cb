// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <array>

#include "plugin/api/parameter_tables.h"
#include "plugin/parameters/place.h"

namespace pm::plugin {

namespace {

constexpr std::array kDiscRows = {
    Parameter<DiscShape>{{.name = "centre",
                          .help = "In object space.",
                          .count = 3,
                          .unit = "scene units",
                          .minimum = -kMaxCoordinate,
                          .maximum = kMaxCoordinate,
                          .defaultText = "0 0 0",
                          .isLater = true},
                         {},
                         {memberPlace<&DiscShape::centre>()}},
    Parameter<DiscShape>{{.name = "normal",
                          .help = "Of its front.",
                          .count = 3,
                          .minimum = -1,
                          .defaultText = "0 0 1",
                          .isLater = true},
                         {},
                         {memberPlace<&DiscShape::normal>()}},
    Parameter<DiscShape>{{.name = "radius",
                          .help = "In object space.",
                          .unit = "scene units",
                          .maximum = kMaxCoordinate,
                          .excludesMinimum = true,
                          .defaultText = "1",
                          .isLater = true},
                         {},
                         {memberPlace<&DiscShape::radius>()}},
};

}  // namespace

std::span<const Parameter<DiscShape>> discParameters() {
    return kDiscRows;
}

}  // namespace pm::plugin
