// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <limits>

#include "integrator/values/vec.h"

namespace pm {

// Empty until it grows.
struct Box3d {
    Vec3d lo{std::numeric_limits<double>::infinity()}, hi{-std::numeric_limits<double>::infinity()};

    bool empty() const { return !(lo.x <= hi.x); }
    Vec3d size() const { return hi - lo; }
    Vec3d middle() const { return (lo + hi) * 0.5; }
    void grow(const Box3d& other) {
        for (int axis = 0; axis < 3; ++axis) {
            lo[axis] = std::min(lo[axis], other.lo[axis]);
            hi[axis] = std::max(hi[axis], other.hi[axis]);
        }
    }
};

}  // namespace pm
