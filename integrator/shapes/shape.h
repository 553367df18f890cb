// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <memory>
#include <variant>

#include "integrator/geometry/polygon_mesh.h"
#include "integrator/shapes/sphere.h"

namespace pm {

// What stands somewhere in a scene. A new kind: a file of its own with its description and what
// CurvedShape asks of it, a line here and one in curved_shape.h.
using Shape = std::variant<std::shared_ptr<const TriangleMesh>, SphereShape>;

}  // namespace pm
