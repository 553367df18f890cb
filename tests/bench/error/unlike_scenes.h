// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>
#include <vector>

#include "tests/support/scene_maker.h"

namespace pm::bench {

struct UnlikeScene {
    std::string key, what;
    test::SceneMaker maker;
    bool byPaths = true;  // path tracing finds all of its light, and soon enough
};

// Twelve scenes as unlike as can be, none of them a box with one lamp under its ceiling; each has a
// kind of light or of surface that an estimate may get wrong. Small: seconds for a few passes.
std::vector<UnlikeScene> unlikeScenes();

// The parts they come from: by day or in the open, and by lamps.
std::vector<UnlikeScene> unlikeScenesByDay();
std::vector<UnlikeScene> unlikeScenesByLamps();

}  // namespace pm::bench
