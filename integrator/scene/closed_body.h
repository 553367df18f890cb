// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <functional>

#include "integrator/values/cancel_check.h"
#include "integrator/values/vec.h"

namespace pm {

// Whether triangles bound a body.
struct BodyShape {
    std::size_t openEdges = 0;  // that no other triangle passes the other way; 0: it is closed
    double volume = 0;          // below 0: turned inside out; means something of closed ones alone
};

// forEach: calls its argument with the corners of each triangle, fronts anticlockwise. Corners are
// one where they are the same to the bit. Throws Error(kCancelled).
BodyShape lookAtBody(
    const std::function<void(const std::function<void(const std::array<Vec3d, 3>&)>&)>& forEach,
    const CancelCheck& cancel);

}  // namespace pm
