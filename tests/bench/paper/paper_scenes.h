// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Our own rooms as plain numbers, and those that stand in for the three scenes of the paper.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/run/neutral_scene.h"

namespace pm::bench {

// A Cornell-like box of 32 triangles around the origin: two boxes, an area light. 256 pixels.
NeutralScene neutralBox();
// The same with two analytic spheres on the boxes, mirror and glass.
NeutralScene neutralBoxWithSpheres();
// The same room with a bumpy ball of about a million triangles in place of boxes and spheres.
NeutralScene neutralRoomWithMesh();

struct PaperScene {
    std::string name;          // "scene-1"
    std::string what;          // in a few words
    NeutralScene scene;        // 256 x 256 pixels
    int cropX = 0, cropY = 0;  // of the 64 x 64 pixels that show edges
    double exposure = 1;       // of pictures for the eye
};

// Three scenes of growing complexity. The paper's own are not published.
std::vector<PaperScene> paperScenes();

}  // namespace pm::bench
