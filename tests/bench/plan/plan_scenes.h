// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/scene_maker.h"

namespace pm::bench {

struct PlanScene {
    std::string key, what;
    test::SceneMaker maker;
    // relMSE to measure the time to: 1e-3, but where that is there after two passes.
    double error = 1e-3;
    std::uint32_t referencePasses = 16;  // of either half; enough for a noise far below that
    bool byPaths = true;                 // path tracing finds all of its light, and soon enough
};

// Scenes that no number of the plan was tuned on, each with another kind of light in it.
std::vector<PlanScene> planScenes();

}  // namespace pm::bench
