// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <optional>

#include "host_shim/look/framing.h"
#include "host_shim/look/occupancy_grid.h"

namespace pm::host {

// Vertical field of view inside of a room, where what is near is wide.
inline constexpr double kRoomFovDegrees = 60.0;

// Where to stand in a scene that is a room, or a house of rooms: seen from outside it would show
// its outer walls. It is one where a closed space (windows may be open) fills a good part of the
// bounds, and
//   the scene's lamps shine into it, or
//   there are none, what is seen from in there are fronts, and from outside backs or a box.
// The eye stands in the widest place of the largest such space and looks, level, along the longest
// view, from as far back as it is half as wide. Nothing where the scene is no room.
std::optional<ViewPoint> viewOfRoom(const OccupancyGrid& grid);

// Whether from a place surface is met in all of 26 directions, or all but one.
bool isClosedAround(const OccupancyGrid& grid, const std::array<double, 3>& place);

}  // namespace pm::host
