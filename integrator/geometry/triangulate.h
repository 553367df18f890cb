// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/geometry/polygon_mesh.h"
#include "integrator/values/cancel_check.h"

namespace pm {

// Cuts the faces of a mesh into triangles, concave and slightly bent ones too; the winding is kept.
// Triangles without area are left out and bad normals replaced by the polygon's own, both counted
// in `repairs`. Normals come out with unit length. Errors: those of validate();
// kCancelled soon after cancel is set. Threads: any, nothing is shared.
BuiltMesh triangulate(const PolygonMesh& mesh, const CancelCheck& cancel = {});

}  // namespace pm
