// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <functional>
#include <limits>
#include <optional>

#include "integrator/values/box.h"

namespace pm {

// Calls what it is given with the box of each triangle and sphere, always in the same order.
using EachBox = std::function<void(const std::function<void(const Box3d&)>&)>;

// A scene of which a few things lie so far from the rest that coordinates from the middle of all
// would leave the rest without digits has a core: the box of what lies together, far less wide than
// the whole, where the camera is nearest, or without one where most is. Nothing otherwise. What is
// too large to be part of a core (a ground to the horizon) doesn't count; where something is larger
// than a core and less wide than a ground, there is none.
// eye: the camera's place.
std::optional<Box3d> findCore(const Box3d& whole, const EachBox& forEachBox,
                              const std::optional<Vec3d>& eye);

// A core is at least so many times less wide than the whole: then roundings of coordinates from the
// middle of all are 1/8000 of the core's width and more.
inline constexpr double kCoreTimes = 4096;

}  // namespace pm
