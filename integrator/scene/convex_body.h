// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/scene/scene.h"

namespace pm {

// Whether all that reflects is the outside of one closed convex body, to rounding, opaque and with
// every light outside: then what leaves it meets it nowhere else, and no light goes from one
// surface by way of another. A sphere, or triangles each edge of which is two triangles' and each
// plane of which has all corners behind it; triangles that only shine need not be a part of it.
// False also of more than 10,000 triangles: telling would take long.
bool isConvexBody(const Scene& scene);

}  // namespace pm
