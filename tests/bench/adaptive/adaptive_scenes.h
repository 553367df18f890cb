// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/scene_maker.h"

namespace pm::bench {

struct AdaptiveScene {
    std::string key, what;
    test::SceneMaker maker;
    // Whether paths find all of its light; the truth is else a long photon render.
    bool byPaths = true;
};

// Scenes whose noise lies in all of the frame, in a quarter of it, and along edges only; then those
// of planScenes(), and the neutral ones where the folder of peers has them.
std::vector<AdaptiveScene> adaptiveScenes(const std::filesystem::path& peers);

}  // namespace pm::bench
