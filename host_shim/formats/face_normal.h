// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "host_shim/formats/scene_data.h"

namespace pm::host {

// Along the normal of a face, as long as twice its area, by Newell's sums. The face has `size`
// corners from mesh.indices[first]; transform: of an instance that has one.
std::array<double, 3> areaNormal(const MeshData& mesh, std::size_t first, std::size_t size,
                                 const std::optional<Transform>& transform = {});

}  // namespace pm::host
