// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/values/vec.h"

namespace pm {

// What of a texture a look-up covers: the parallelogram that these two sides span around its
// middle, in uv units. Without sides it is the finest level that is looked up.
struct UvFootprint {
    Vec2f x, y;

    bool isPoint() const { return x.x == 0.0f && x.y == 0.0f && y.x == 0.0f && y.y == 0.0f; }
};

}  // namespace pm
