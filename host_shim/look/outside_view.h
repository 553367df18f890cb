// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <optional>

#include "host_shim/look/framing.h"
#include "host_shim/look/occupancy_grid.h"

namespace pm::host {

struct OutsideView {
    std::array<double, 3> frontEye{};  // where the camera stands by default
    const Bounds& bounds;
    double verticalFov{};  // radians
    double aspect{};       // width / height
};

// Where to stand instead, with all surface just in the picture, where from the front much less of
// the scene's surface is seen than from elsewhere: a ground from the side, a box from straight
// ahead, a room that is open above or at a side. Candidates are views from above to the right and
// left and steeply, along x, and from behind. Nothing where the front shows at least half as
// much as the best of them.
std::optional<ViewPoint> betterView(const OccupancyGrid& grid, const OutsideView& view);

// Whether the scene stands on the plane z = 0 as on a ground: of its lowest layers of cells the one
// along z has several times as much level surface as the one along y, and much rises above it.
// Exporters of modelling programs whose z is up don't say so.
bool standsOnZ(const OccupancyGrid& grid, const Bounds& bounds);

}  // namespace pm::host
