// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>

#include "plugin/include/pm_plugin.h"

namespace pm::test {

// Writes the picture that the floor of transportScene() is textured with: a pixmap as text.
void writeFloorTexture(const std::string& file);

struct SceneChoice {
    // What writeFloorTexture() wrote. Empty gives a soft scene instead, diffuse and with a broad
    // lamp only, whose picture has little noise.
    std::string texture{};
    double cameraX = 0, cameraY = 0, cameraZ = 3.5;  // it looks along -z; the room is 2 wide
};

// A room that is open towards the camera, made through the interface and committed, with every kind
// of transport that there is: diffuse, textured, glossy, mirror, glass and half transparent
// surfaces; a flat lamp, a spherical one and a point light. A grown-up sibling of makeBoxScene().
// Errors fail the test that calls.
PmrScene transportScene(PmrContext context, const SceneChoice& choice);

}  // namespace pm::test
