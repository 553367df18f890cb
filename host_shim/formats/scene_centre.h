// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <functional>
#include <optional>

#include "host_shim/formats/scene_data.h"

namespace pm::host {

// Calls what it is given with the bounds of each face, always in the same order.
using EachFace = std::function<void(const std::function<void(const Bounds&)>&)>;

// What to subtract from positions before they become floats: the middle of the bounds, unless a few
// faces lie so far from the others that from there these would have no digits left. Then the middle
// of what lies together where the camera stands nearest or, without a camera, where most faces are.
std::array<double, 3> centreFor(const EachFace& forEachFace, const Bounds& bounds,
                                const std::optional<std::array<double, 3>>& eye);

}  // namespace pm::host
