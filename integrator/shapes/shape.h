// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <memory>
#include <variant>

#include "integrator/geometry/polygon_mesh.h"
#include "integrator/values/vec.h"

namespace pm {

// An analytic sphere in object space; its front is outside. Under a transform it must stay a
// sphere: rotation, translation, uniform scale. Textures are latitude-longitude pictures: in object
// space their middle is towards +z, their right half towards +x, their upper edge at +y; so a
// camera that isn't turned sees the middle as it is.
struct SphereShape {
    Vec3d centre;
    double radius = 1.0;  // > 0, scene units
};

using Shape = std::variant<std::shared_ptr<const TriangleMesh>, SphereShape>;

}  // namespace pm
