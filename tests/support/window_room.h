// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "tests/support/scene_maker.h"

namespace pm::test {

// A closed room from -1 to 1 whose ceiling has a square window, so wide by half, over its middle
// or beside it.
inline SceneMaker windowRoom(double half, Rgb floor, Rgb walls, double middle = 0) {
    SceneMaker maker;
    const auto wall = maker.diffuse(walls);
    maker.quad({-1, -1, 1}, {2, 0, 0}, {0, 0, -2}, maker.diffuse(floor));
    maker.quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, wall);
    maker.quad({-1, -1, 1}, {0, 0, -2}, {0, 2, 0}, wall);
    maker.quad({1, -1, -1}, {0, 0, 2}, {0, 2, 0}, wall);
    maker.quad({1, -1, 1}, {-2, 0, 0}, {0, 2, 0}, wall);
    const double left = middle - half, right = middle + half;
    maker.quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 1 - half}, wall);
    maker.quad({-1, 1, half}, {2, 0, 0}, {0, 0, 1 - half}, wall);
    maker.quad({-1, 1, -half}, {1 + left, 0, 0}, {0, 0, 2 * half}, wall);
    maker.quad({right, 1, -half}, {1 - right, 0, 0}, {0, 0, 2 * half}, wall);
    maker.camera({0, 0, 0.95}, {0, -0.5, -1}, {0, 1, 0}, 70);
    return maker;
}

}  // namespace pm::test
