// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "host_shim/formats/scene_data.h"

namespace pm::host {

// Multiplies each coordinate of vertices and spheres, and radii, by 1 + 1e-7 u, u in [-1, 1]. u is
// a hash of the place and of `twin`, so that equal vertices stay equal. What a render of it differs
// by is what rounding otherwise makes of the same scene and seed: another compiler, another
// instruction set.
void makeTwin(std::uint32_t twin, SceneData& scene);

}  // namespace pm::host
