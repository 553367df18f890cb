// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/plan/plan_scenes.h"

#include "tests/support/rooms.h"

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

// A room of diffuse things by the sky and a low sun, through one window: most of what the camera
// sees is lit by way of walls.
test::SceneMaker window() {
    test::SceneMaker maker;
    const auto plaster = maker.diffuse({0.75f, 0.72f, 0.65f}),
               wood = maker.diffuse({0.45f, 0.3f, 0.18f});
    const auto green = maker.diffuse({0.25f, 0.4f, 0.22f});
    maker.quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, wood);
    maker.quad({-2, 2.6, -2}, {4, 0, 0}, {0, 0, 4}, plaster);
    maker.quad({-2, 0, -2}, {4, 0, 0}, {0, 2.6, 0}, plaster);
    maker.quad({2, 0, -2}, {0, 0, 4}, {0, 2.6, 0}, green);
    maker.quad({2, 0, 2}, {-4, 0, 0}, {0, 2.6, 0}, plaster);
    // The wall with the window, in four parts.
    maker.quad({-2, 0, 2}, {0, 0, -4}, {0, 0.9, 0}, plaster);
    maker.quad({-2, 2.1, 2}, {0, 0, -4}, {0, 0.5, 0}, plaster);
    maker.quad({-2, 0.9, 2}, {0, 0, -2}, {0, 1.2, 0}, plaster);
    maker.quad({-2, 0.9, -1.2}, {0, 0, -0.8}, {0, 1.2, 0}, plaster);
    maker.box({0.2, 0.65, -1.2}, {1.5, 0.72, -0.3}, wood, false);
    for (const double x : {0.25, 1.38})
        for (const double z : {-1.15, -0.42})
            maker.box({x, 0, z}, {x + 0.07, 0.65, z + 0.07}, wood, false);
    maker.meshSphere({0.8, 0.94, -0.8}, 0.22, green, false, 24);
    maker.box({-1.6, 0, -1.9}, {-0.7, 1.7, -1.5}, wood, false);
    maker.sky({2.0f, 2.6f, 3.6f});
    maker.sun({1, -0.62, 0.15}, {42.0f, 36.0f, 26.0f}, 0.005);
    maker.camera({1.5, 1.5, 1.8}, {-0.2, 0.9, -1.2}, {0, 1, 0}, 52);
    return maker;
}

// A bulb in a globe of glass over a table with a glass of water, columns behind: all light comes
// through glass, and through more glass where it falls on the table.
test::SceneMaker lantern() {
    test::SceneMaker maker;
    const auto stone = maker.diffuse({0.55f, 0.52f, 0.48f}),
               red = maker.diffuse({0.5f, 0.18f, 0.14f});
    const auto pane = maker.material(test::glass()), air = maker.material(test::air());
    maker.quad({-2.2, 0, 2.2}, {4.4, 0, 0}, {0, 0, -4.4}, stone);
    maker.quad({-2.2, 0, -2.2}, {4.4, 0, 0}, {0, 2.8, 0}, stone);
    maker.quad({-2.2, 0, 2.2}, {0, 0, -4.4}, {0, 2.8, 0}, stone);
    maker.quad({2.2, 0, -2.2}, {0, 0, 4.4}, {0, 2.8, 0}, red);
    maker.quad({-2.2, 2.8, -2.2}, {4.4, 0, 0}, {0, 0, 4.4}, stone);
    maker.box({-0.7, 0.68, -0.6}, {0.7, 0.75, 0.5}, red, false);
    maker.box({-0.1, 0, -0.15}, {0.1, 0.68, 0.05}, red, false);
    for (const double x : {-1.5, 1.2}) maker.box({x, 0, -1.9}, {x + 0.3, 2.8, -1.6}, stone, false);
    maker.sphere({0.1, 1.75, -0.1}, 0.26, pane);
    maker.sphere({0.1, 1.75, -0.1}, 0.24, air);
    maker.meshSphere({0.1, 1.75, -0.1}, 0.07, maker.diffuse({}, {150.0f, 120.0f, 75.0f}), false,
                     12);
    maker.sphere({-0.3, 0.94, 0.1}, 0.18, maker.material(test::glass(1.33f)));
    maker.camera({0.5, 1.6, 2.1}, {0, 0.95, -0.4}, {0, 1, 0}, 54);
    return maker;
}

// Three spots on a wall of pictures, a mirroring ball on a plinth and a standing mirror: small
// bright fields, light thrown about by mirrors, the rest dim.
test::SceneMaker gallery() {
    test::SceneMaker maker;
    const auto white = maker.diffuse(Rgb(0.72f)), floor = maker.diffuse({0.3f, 0.27f, 0.25f});
    const auto metal = maker.material(test::mirror(0.9f));
    maker.quad({-3, 0, 2.5}, {6, 0, 0}, {0, 0, -4.5}, floor);
    maker.quad({-3, 3, -2}, {6, 0, 0}, {0, 0, 4.5}, white);
    maker.quad({-3, 0, -2}, {6, 0, 0}, {0, 3, 0}, white);
    maker.quad({-3, 0, 2.5}, {0, 0, -4.5}, {0, 3, 0}, white);
    maker.quad({3, 0, -2}, {0, 0, 4.5}, {0, 3, 0}, white);
    for (int i = 0; i < 3; ++i) {
        const double x = -2.3 + 1.7 * i;
        const auto i0 = static_cast<float>(i);
        maker.quad({x, 1, -1.98}, {1.1, 0, 0}, {0, 0.9, 0},
                   maker.diffuse({0.15f + 0.2f * i0, 0.35f, 0.5f - 0.18f * i0}));
        maker.spot({x + 0.55, 2.9, -0.4}, {0, -1.45, -1.6}, Rgb(14.0f, 12.5f, 10.5f), 0.42, 0.12);
    }
    maker.box({-0.3, 0, -0.5}, {0.3, 0.8, 0.1}, white, false);
    maker.sphere({0, 1.12, -0.2}, 0.32, metal);
    maker.quad({1.5, 0.1, -1.6}, {0.6, 0, 0.8}, {0, 1.9, 0}, metal);
    maker.spot({1.2, 2.9, 1.4}, {-1.2, -1.8, -1.6}, Rgb(16.0f, 15.0f, 13.0f), 0.3, 0.1);
    maker.camera({0.2, 1.5, 2.4}, {0.1, 1.15, -1.5}, {0, 1, 0}, 58);
    return maker;
}

}  // namespace

std::vector<PlanScene> planScenes() {
    return {
        {"hall", "a hall with 24 lamps, all diffuse", hall(), 3e-4, 8},
        {"mirror", "a room with a large lamp, a mirror and a mirroring ball", mirrorRoom()},
        {"window", "a diffuse room by sky and sun through a window", window(), 1e-3, 16, false},
        {"glass", "glass on a table in the open by a point light", glassTable(), 1e-3, 16, false},
        {"lantern", "a bulb in a globe of glass over a table", lantern(), 1e-3, 16, false},
        {"gallery", "spots on a wall, a mirroring ball and a mirror", gallery(), 1e-3, 16, false}};
}

}  // namespace pm::bench
