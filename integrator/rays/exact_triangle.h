// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>

#include "integrator/values/vec.h"

namespace pm {

// A triangle that is intersected in double: one so huge that float's roundings of it matter.
struct ExactTriangle {
    std::uint32_t primitive = 0;  // its number in its shape
    std::array<Vec3d, 3> corners;
};

}  // namespace pm
