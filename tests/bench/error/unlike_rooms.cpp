// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <cmath>
#include <utility>

#include "tests/bench/error/unlike_scenes.h"
#include "tests/bench/plan/plan_scenes.h"
#include "tests/support/rooms.h"

namespace pm::bench {

namespace {

// What exporters write for everything: paint under a clear coat.
std::uint32_t plastic(test::SceneMaker& maker, Rgb diffuse, float exponent = 250.0f) {
    MaterialDescription m;
    m.diffuse = diffuse;
    m.glossy = Rgb(0.04f);
    m.glossyExponent = exponent;
    return maker.material(m);
}

void lampBelow(test::SceneMaker& maker, const Vec3d& centre, double half, Rgb radiance) {
    maker.quad({centre.x - half, centre.y, centre.z - half}, {2 * half, 0, 0}, {0, 0, 2 * half},
               maker.diffuse({}, radiance));
}

// A closed dim room of thin walls on a floor that goes on outside, where it is bright.
test::SceneMaker closedRoom() {
    test::SceneMaker maker;
    const auto white = maker.diffuse(Rgb(0.7f)), blue = maker.diffuse({0.25f, 0.35f, 0.6f});
    maker.quad({-6, 0, 6}, {12, 0, 0}, {0, 0, -12}, maker.diffuse(Rgb(0.6f)));
    constexpr double kThick = 0.02;
    maker.box({-1 - kThick, 0, -1}, {-1, 1.4, 1}, blue, false);
    maker.box({1, 0, -1}, {1 + kThick, 1.4, 1}, white, false);
    maker.box({-1 - kThick, 0, -1 - kThick}, {1 + kThick, 1.4, -1}, white, false);
    maker.box({-1 - kThick, 0, 1}, {1 + kThick, 1.4, 1 + kThick}, white, false);
    maker.box({-1 - kThick, 1.4, -1 - kThick}, {1 + kThick, 1.4 + kThick, 1 + kThick}, white,
              false);
    maker.box({-0.6, 0, -0.7}, {-0.1, 0.5, -0.2}, white, false);
    lampBelow(maker, {0.2, 1.38, 0}, 0.2, Rgb(12.0f, 11.0f, 9.0f));
    lampBelow(maker, {-3, 2.5, -1}, 1, Rgb(60.0f));
    maker.camera({0.8, 1.1, 0.85}, {-0.5, 0.3, -0.5}, {0, 1, 0}, 58);
    return maker;
}

// A hall where everything has a weak and broad gloss.
test::SceneMaker glossyHall() {
    test::SceneMaker maker;
    const auto coated = [&](Rgb diffuse, float gloss, float exponent) {
        MaterialDescription m;
        m.diffuse = diffuse;
        m.glossy = Rgb(gloss);
        m.glossyExponent = exponent;
        return maker.material(m);
    };
    const auto floor = coated({0.35f, 0.3f, 0.25f}, 0.15f, 60), wall = coated(Rgb(0.6f), 0.05f, 20);
    const auto stone = coated({0.5f, 0.3f, 0.25f}, 0.2f, 35);
    maker.quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -8}, floor);
    maker.quad({-3, 2.8, -5}, {6, 0, 0}, {0, 0, 8}, wall);
    maker.quad({-3, 0, -5}, {6, 0, 0}, {0, 2.8, 0}, wall);
    maker.quad({-3, 0, 3}, {0, 0, -8}, {0, 2.8, 0}, wall);
    maker.quad({3, 0, -5}, {0, 0, 8}, {0, 2.8, 0}, wall);
    for (int i = 0; i < 4; ++i)
        for (const double x : {-1.7, 1.4})
            maker.box({x, 0, -4.2 + 1.7 * i}, {x + 0.3, 2.8, -3.9 + 1.7 * i}, stone, false);
    maker.meshSphere({0.2, 0.4, -1.2}, 0.4, stone, false, 16);
    for (int i = 0; i < 3; ++i)
        lampBelow(maker, {-2.4 + 2.4 * i, 2.75, -3.4 + 1.9 * i}, 0.25, Rgb(22.0f, 20.0f, 16.0f));
    maker.camera({0.3, 1.7, 2.8}, {-0.1, 0.8, -2}, {0, 1, 0}, 52);
    return maker;
}

void addTable(test::SceneMaker& maker, const Vec3d& lo, const Vec3d& hi, std::uint32_t material) {
    constexpr double kTop = 0.04, kLeg = 0.05;
    maker.box({lo.x, hi.y - kTop, lo.z}, hi, material, false);
    for (const double x : {lo.x, hi.x - kLeg})
        for (const double z : {lo.z, hi.z - kLeg})
            maker.box({x, lo.y, z}, {x + kLeg, hi.y - kTop, z + kLeg}, material, false);
}

// A room full of furniture, all of it plastic but a ball of gold and one of glass.
test::SceneMaker furnished() {
    test::SceneMaker maker;
    const auto floor = plastic(maker, {0.5f, 0.3f, 0.15f}, 360);
    const auto wall = plastic(maker, Rgb(0.75f)), red = plastic(maker, {0.6f, 0.12f, 0.1f});
    const auto blue = plastic(maker, {0.1f, 0.2f, 0.7f}),
               wood = plastic(maker, {0.4f, 0.25f, 0.12f});
    maker.quad({-2.5, 0, 2.5}, {5, 0, 0}, {0, 0, -5}, floor);
    maker.quad({-2.5, 2.6, -2.5}, {5, 0, 0}, {0, 0, 5}, wall);
    maker.quad({-2.5, 0, -2.5}, {5, 0, 0}, {0, 2.6, 0}, wall);
    maker.quad({-2.5, 0, 2.5}, {0, 0, -5}, {0, 2.6, 0}, wall);
    maker.quad({2.5, 0, -2.5}, {0, 0, 5}, {0, 2.6, 0}, wall);
    addTable(maker, {-0.8, 0, -1.1}, {0.8, 0.74, 0}, wood);
    for (int i = 0; i < 4; ++i) {
        const double x = i % 2 == 0 ? -0.55 : 0.15, z = i < 2 ? -1.6 : 0.15;
        addTable(maker, {x, 0, z}, {x + 0.4, 0.45, z + 0.4}, i == 1 ? red : blue);
        const double back = i < 2 ? z : z + 0.36;
        maker.box({x, 0.45, back}, {x + 0.4, 0.95, back + 0.04}, i == 1 ? red : blue, false);
    }
    for (int i = 0; i < 5; ++i) {
        maker.box({-2.45, 0.4 * i, -2}, {-2.1, 0.4 * i + 0.03, -0.4}, wood, false);
        for (int book = 0; book < 9; ++book) {
            const double z = -1.95 + 0.17 * book, high = 0.22 + 0.03 * ((book + i) % 4);
            maker.box({-2.42, 0.4 * i + 0.03, z}, {-2.18, 0.4 * i + 0.03 + high, z + 0.06},
                      (book + i) % 3 == 0   ? red
                      : (book + i) % 3 == 1 ? blue
                                            : wall,
                      false);
        }
    }
    maker.box({1.5, 0, -2.2}, {2.4, 0.4, -0.4}, red, false);
    maker.box({2.15, 0.4, -2.2}, {2.4, 0.9, -0.4}, red, false);
    MaterialDescription gold;
    gold.kind = MaterialKind::kMirror;
    gold.glossy = {1.0f, 0.77f, 0.34f};
    gold.glossyExponent = 640;
    maker.meshSphere({-0.35, 0.88, -0.6}, 0.14, maker.material(gold), false, 16);
    maker.sphere({0.3, 0.9, -0.45}, 0.16, maker.material(test::glass(1.45f)));
    maker.meshSphere({1.2, 0.25, 0.5}, 0.25, blue, false, 16);
    lampBelow(maker, {0, 2.55, -0.5}, 0.4, Rgb(14.0f, 12.6f, 11.2f));
    maker.camera({0.6, 1.6, 2.4}, {-0.2, 0.8, -0.9}, {0, 1, 0}, 56);
    return maker;
}

// Crates a millimetre above a floor, one against a wall, boards on each other.
test::SceneMaker thinGaps() {
    test::SceneMaker maker;
    const auto grey = maker.diffuse(Rgb(0.6f)), wood = maker.diffuse({0.5f, 0.38f, 0.24f});
    maker.quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -3.5}, grey);
    maker.quad({-2, 0, -1.5}, {4, 0, 0}, {0, 2, 0}, maker.diffuse({0.55f, 0.6f, 0.7f}));
    constexpr double kGap = 0.001;
    for (int i = 0; i < 3; ++i)
        maker.box({-1.3 + 0.9 * i, kGap, -0.9 + 0.4 * i}, {-0.7 + 0.9 * i, 0.45, -0.3 + 0.4 * i},
                  wood, false);
    maker.box({-1.7, 0.3, -1.5 + kGap}, {-1.1, 1.1, -1.35}, wood, false);
    for (int i = 0; i < 6; ++i) {
        const double y = 0.05 * i + kGap;
        maker.box({0.9, y, -1.2}, {1.7, y + 0.05 - 2 * kGap, -0.8}, wood, false);
    }
    maker.quad({1.9, 0.6, 1.2}, {0, 0, -0.7}, {0, 0.7, 0}, maker.diffuse({}, Rgb(14.0f)));
    maker.quad({-0.4, 1.99, -0.4}, {0.3, 0, 0}, {0, 0, 0.3},
               maker.diffuse({}, {20.0f, 17.0f, 12.0f}));
    maker.camera({0.2, 1.1, 2.3}, {0, 0.3, -0.4}, {0, 1, 0}, 46);
    return maker;
}

// A fair by night: 160 small lamps of all colours over stalls.
test::SceneMaker manyLamps() {
    test::SceneMaker maker;
    const auto ground = maker.diffuse(Rgb(0.45f)), cloth = maker.diffuse({0.6f, 0.5f, 0.4f});
    maker.quad({-5, 0, 3}, {10, 0, 0}, {0, 0, -10}, ground);
    maker.quad({-5, 0, -5}, {10, 0, 0}, {0, 3.5, 0}, cloth);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 2; ++j) {
            const double x = -3.6 + 2 * i, z = -3.5 + 2.6 * j;
            addTable(maker, {x, 0, z}, {x + 1.2, 0.8, z + 0.7}, cloth);
            maker.box({x - 0.1, 1.9, z - 0.1}, {x + 1.3, 1.94, z + 0.8}, cloth, false);
        }
    for (int i = 0; i < 160; ++i) {
        const double x = -4.5 + 9 * std::fmod(0.7548776662 * i, 1.0);
        const double z = -4.6 + 6.5 * std::fmod(0.5698402910 * i, 1.0);
        const auto t = static_cast<float>(i % 5) / 4;
        lampBelow(maker, {x, 2.1 + 0.05 * (i % 7), z}, 0.03 + 0.006 * (i % 4),
                  Rgb(1.0f, 0.35f + 0.6f * t, 1.0f - 0.8f * t) * 60.0f);
    }
    maker.camera({0.5, 1.7, 3.6}, {0, 0.8, -2}, {0, 1, 0}, 50);
    return maker;
}

// What is seen of a cupboard through the gap of its door.
test::SceneMaker cupboard() {
    test::SceneMaker maker;
    const auto wall = maker.diffuse({0.7f, 0.68f, 0.6f}),
               wood = maker.diffuse({0.55f, 0.4f, 0.28f});
    maker.quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, maker.diffuse(Rgb(0.5f)));
    maker.quad({-2, 0, -2}, {4, 0, 0}, {0, 2.5, 0}, wall);
    maker.quad({-2, 0, 2}, {0, 0, -4}, {0, 2.5, 0}, wall);
    maker.quad({2, 0, -2}, {0, 0, 4}, {0, 2.5, 0}, wall);
    constexpr double kBoard = 0.015;
    const Vec3d lo{-0.6, 0, -1.9}, hi{0.6, 1.8, -1.4};
    maker.box(lo, {hi.x, kBoard, hi.z}, wood, false);
    maker.box({lo.x, hi.y, lo.z}, {hi.x, hi.y + kBoard, hi.z}, wood, false);
    maker.box({lo.x - kBoard, 0, lo.z}, {lo.x, hi.y + kBoard, hi.z}, wood, false);
    maker.box({hi.x, 0, lo.z}, {hi.x + kBoard, hi.y + kBoard, hi.z}, wood, false);
    maker.box({lo.x, 0, lo.z - kBoard}, {hi.x, hi.y, lo.z}, wood, false);
    for (const double y : {0.6, 1.2})
        maker.box({lo.x, y, lo.z}, {hi.x, y + kBoard, hi.z - 0.05}, wood, false);
    for (int i = 0; i < 4; ++i)
        maker.box({-0.5 + 0.28 * i, 0.615, -1.8}, {-0.35 + 0.28 * i, 0.8 + 0.1 * (i % 3), -1.6},
                  wall, false);
    // Its doors, one shut and one ajar by 35 degrees, as sheets.
    maker.quad({lo.x, 0.01, hi.z + 0.001}, {0.595, 0, 0}, {0, hi.y - 0.01, 0}, wood);
    maker.quad({hi.x, 0.01, hi.z + 0.001}, {-0.6 * std::cos(0.6), 0, 0.6 * std::sin(0.6)},
               {0, hi.y - 0.01, 0}, wood);
    lampBelow(maker, {-0.8, 2.4, 0.6}, 0.3, Rgb(20.0f, 18.0f, 15.0f));
    maker.camera({-0.55, 1.25, 0.1}, {0.3, 0.8, -1.6}, {0, 1, 0}, 52);
    return maker;
}

test::SceneMaker lantern() {
    for (PlanScene& scene : planScenes())
        if (scene.key == "lantern") return std::move(scene.maker);
    return {};
}

}  // namespace

std::vector<UnlikeScene> unlikeScenesByLamps() {
    return {{"closed", "a dim closed room on a floor that is bright outside", closedRoom()},
            {"glossy", "a hall of weak and broad gloss", glossyHall()},
            {"furnished", "a room of plastic furniture, gold and glass", furnished()},
            {"gaps", "crates and boards a millimetre apart", thinGaps()},
            {"lamps", "stalls under 160 lamps", manyLamps()},
            {"cupboard", "inside of a cupboard with its door ajar", cupboard()},
            {"lantern", "a bulb in a globe of glass over a table", lantern(), false}};
}

}  // namespace pm::bench
