// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/formats/pov/values/value.h"
#include "host_shim/formats/scene_data.h"

namespace pm::host::pov {

// The faces of a triangle, smooth_triangle, mesh, mesh2, polygon or bicubic_patch in our space, of
// one material slot. False: it is none of them, or it has no face.
// Errors: kBadInput, with the place, for numbers of vertices that there are not.
bool meshOf(const Node& node, MeshData& mesh);

}  // namespace pm::host::pov
