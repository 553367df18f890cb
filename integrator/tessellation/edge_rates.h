// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "integrator/geometry/limit_shape.h"
#include "integrator/values/cancel_check.h"
#include "integrator/values/transform.h"
#include "integrator/values/vec.h"

namespace pm {

// Where surfaces are looked at from, scene's own coordinates.
struct Viewpoint {
    Vec3d eye;
    Vec3d forward;             // unit
    double halfAngle = 0;      // of a cone that holds all of the picture, radians
    double radiansAPiece = 0;  // what a piece of an edge is to be seen under
};

// How finely a shape is cut: every edge alike, or by a viewpoint.
struct TessellationRule {
    int rate = 0;  // pieces of every edge, as far as faces allow; 0: see below
    std::optional<Viewpoint> viewpoint;  // none: the shape's own rate
};

// The pieces of each edge of a cage that stands in a scene: so many that none is seen under more
// than radiansAPiece, a quarter of them out of the picture, where only light is to find them. By
// the edge's own ends alone, so that both of its faces agree. Throws Error(kCancelled).
std::vector<std::uint16_t> edgeRates(const LimitShape& shape, const Transform& toScene,
                                     const TessellationRule& rule, const CancelCheck& cancel);

}  // namespace pm
