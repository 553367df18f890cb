// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>

#include "host_shim/formats/pov/evaluation/parser.h"
#include "host_shim/formats/scene_data.h"

namespace pm::host::pov {

// What of a scene is not rendered: by its name, how many there are and where the first stands.
struct LeftOut {
    std::uint64_t count{};
    Place first;
};

struct SceneOf {
    SceneData data;
    std::map<std::string, LeftOut> leftOut;  // "box: waits for shapes", ...
    std::uint64_t objects{}, lights{}, cameras{};
};

// Spheres, triangles and meshes with one colour each; the last camera, for a picture of size.
SceneOf sceneOf(const Evaluated& scene, const std::array<std::int32_t, 2>& size);

}  // namespace pm::host::pov
