// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>

#include "tests/integrator/scene_maker.h"

namespace pm::bench {

// One of the three neutral scenes that other renderers were measured on.
struct NeutralScene {
    std::string name;  // "cornell-diffuse", "cornell-caustic", "sds"
    test::SceneMaker maker;
    std::int32_t size = 0;  // pixels, square
};

// key: A, B or C of the file scenes.json. Throws nlohmann::json::exception or Error(kIo).
NeutralScene readNeutralScene(const std::filesystem::path& file, const std::string& key);

// A Cornell-like box of 32 triangles: two boxes, an area light; the scene's centre is at the
// origin.
test::SceneMaker plainBox();
// The same with two analytic spheres on the boxes, mirror and glass.
test::SceneMaker boxWithSpheres();
// The same room with a bumpy ball of about a million triangles in place of boxes and spheres.
test::SceneMaker roomWithMesh();

}  // namespace pm::bench
