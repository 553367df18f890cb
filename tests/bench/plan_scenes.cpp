// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/plan_scenes.h"

#include "tests/integrator/rooms.h"

namespace pm::bench {

namespace {

// A hall with 24 lamps of unlike size and colour under the ceiling, which the camera does not see,
// shelves on both sides and a wall across half of it: direct light of many shadows.
test::SceneMaker hall() {
    test::SceneMaker maker;
    const auto white = maker.diffuse(Rgb(0.7f)), blue = maker.diffuse({0.2f, 0.3f, 0.6f});
    const auto brown = maker.diffuse({0.5f, 0.35f, 0.2f});
    maker.quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -9}, brown);
    maker.quad({-3, 3, -6}, {6, 0, 0}, {0, 0, 9}, white);
    maker.quad({-3, 0, -6}, {6, 0, 0}, {0, 3, 0}, blue);
    maker.quad({-3, 0, 3}, {0, 0, -9}, {0, 3, 0}, white);
    maker.quad({3, 0, -6}, {0, 0, 9}, {0, 3, 0}, white);
    maker.box({-3, 0, -2.6}, {-0.5, 2.2, -2.4}, white, false);
    for (int i = 0; i < 4; ++i) {
        const double z = -5 + 1.6 * i;
        maker.box({-2.9, 0.5 * i, z}, {-2.3, 0.5 * i + 0.1, z + 1.2}, blue, false);
        maker.box({2.2, 0, z}, {2.8, 1.6, z + 0.4}, brown, false);
    }
    for (int row = 0; row < 6; ++row)
        for (int column = 0; column < 4; ++column) {
            const double half = 0.06 + 0.03 * ((row + 2 * column) % 4);
            const float warm = 0.4f + 0.3f * static_cast<float>((row + column) % 3);
            const auto lamp = maker.diffuse({}, Rgb(1.0f, 0.8f, warm) * 14.0f);
            maker.quad({-2.3 + 1.5 * column - half, 2.9, -5.2 + 1.4 * row - half}, {2 * half, 0, 0},
                       {0, 0, 2 * half}, lamp);
        }
    maker.camera({0.4, 2.4, 2.9}, {0, 0.6, -2.6}, {0, 1, 0}, 40);
    return maker;
}

// The room of the tests with a large lamp in view, a mirror on the wall and a ball of Fresnel's
// reflectance: soft light, much of it seen or thrown by way of a mirror.
test::SceneMaker mirrorRoom() {
    for (test::Room& room : test::roomsOfEveryLobe())
        if (room.name == "mirror") return std::move(room.maker);
    return {};
}

// A glass ball, a hollow one and a block of tinted glass on a table before a wall, by a point
// light, nothing around: sharp caustics, little indirect light.
test::SceneMaker glassTable() {
    test::SceneMaker maker;
    const auto table = maker.diffuse({0.6f, 0.55f, 0.5f});
    maker.quad({-3, 0, 2}, {6, 0, 0}, {0, 0, -4}, table);
    maker.quad({-3, 0, -2}, {6, 0, 0}, {0, 3, 0}, maker.diffuse(Rgb(0.5f)));
    maker.sphere({-0.7, 0.5, 0.2}, 0.45, maker.material(test::glass()));
    maker.sphere({0.55, 0.5, -0.5}, 0.45, maker.material(test::glass(1.33f)));
    maker.sphere({0.55, 0.5, -0.5}, 0.38, maker.material(test::glass(1 / 1.33f)));
    MaterialDescription tinted = test::glass(1.6f);
    tinted.transmission = Rgb(0.9f, 0.6f, 0.5f);
    maker.box({0.3, 0.02, 0.5}, {0.9, 0.3, 0.9}, maker.material(tinted), false);
    maker.pointLight({-1.4, 3, 0.8}, Rgb(10.0f));
    maker.camera({0, 1.6, 4}, {0, 0.45, 0}, {0, 1, 0}, 32);
    return maker;
}

}  // namespace

std::vector<PlanScene> planScenes() {
    return {{"hall", "a hall with 24 lamps, all diffuse", hall(), 3e-4, 8},
            {"mirror", "a room with a large lamp, a mirror and a mirroring ball", mirrorRoom()},
            {"glass", "glass on a table in the open by a point light", glassTable()}};
}

}  // namespace pm::bench
