// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <memory>
#include <variant>

#include "integrator/geometry/limit_shape.h"
#include "integrator/geometry/polygon_mesh.h"
#include "integrator/shapes/in_object_space.h"
#include "integrator/shapes/sphere.h"

namespace pm {

// What stands somewhere in a scene, and the kinds that are no meshes where they stand. A new kind:
// a file of its own with its description and what CurvedShape asks of it, and a word in each of
// these lines; InObjectSpace serves what is described in its own space. A limit shape is cut into
// triangles where and when rays meet it.
using Shape = std::variant<std::shared_ptr<const TriangleMesh>, std::shared_ptr<const LimitShape>,
                           SphereShape>;
using CurvedKind = std::variant<PlacedSphere, InObjectSpace<SphereShape>>;

}  // namespace pm
