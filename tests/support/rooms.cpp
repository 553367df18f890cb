// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/support/rooms.h"

#include <algorithm>

namespace pm::test {

MaterialDescription glass(float ior) {
    MaterialDescription m;
    m.kind = MaterialKind::kDielectric;
    m.ior = ior;
    return m;
}

MaterialDescription air() {
    MaterialDescription m = glass(1.0f);
    m.priority = 1;
    return m;
}

MaterialDescription mirror(float reflectance) {
    MaterialDescription m;
    m.kind = MaterialKind::kMirror;
    m.glossy = Rgb(reflectance);
    return m;
}

SceneMaker openRoom() {
    SceneMaker maker;
    const auto white = maker.diffuse(Rgb(0.7f));
    maker.quad({-1, -1, 1}, {2, 0, 0}, {0, 0, -2}, white);                              // floor
    maker.quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, white);                               // ceiling
    maker.quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, white);                              // back
    maker.quad({-1, -1, 1}, {0, 0, -2}, {0, 2, 0}, maker.diffuse({0.6f, 0.1f, 0.1f}));  // left
    maker.quad({1, -1, -1}, {0, 0, 2}, {0, 2, 0}, maker.diffuse({0.1f, 0.5f, 0.1f}));   // right
    maker.camera({0, 0, 4.2}, {0, 0, 0}, {0, 1, 0}, 36);
    return maker;
}

void ceilingLamp(SceneMaker& maker, double half, Rgb radiance) {
    maker.quad({-half, 0.95, -half}, {2 * half, 0, 0}, {0, 0, 2 * half},
               maker.diffuse({}, radiance));
}

namespace {

SceneMaker litRoom() {
    SceneMaker maker = openRoom();
    ceilingLamp(maker, 0.5, Rgb(8.0f));
    return maker;
}

SceneMaker diffuseRoom() {
    SceneMaker maker = litRoom();
    const auto grey = maker.diffuse(Rgb(0.5f));
    maker.box({-0.7, -1, -0.7}, {-0.1, 0.2, -0.1}, grey, false);
    maker.box({0.1, -1, -0.2}, {0.7, -0.4, 0.4}, grey, false);
    return maker;
}

// Diffuse and broad on one surface, a broad lobe alone, and a narrow one.
SceneMaker glossyRoom() {
    SceneMaker maker = litRoom();
    MaterialDescription both;
    both.diffuse = Rgb(0.3f, 0.4f, 0.2f);
    both.glossy = Rgb(0.4f);
    both.glossyExponent = 20;
    maker.box({-0.7, -1, -0.7}, {-0.1, 0.2, -0.1}, maker.material(both), false);
    MaterialDescription rough = mirror();
    rough.glossyExponent = 40;
    maker.sphere({0.5, -0.7, -0.4}, 0.3, maker.material(rough));
    rough.glossyExponent = 100;
    maker.sphere({0.3, -0.7, 0.4}, 0.3, maker.material(rough));
    return maker;
}

SceneMaker mirrorRoom() {
    SceneMaker maker = litRoom();
    MaterialDescription fresnel = mirror(0.3f);
    fresnel.fresnelMirror = true;
    maker.sphere({0.4, -0.6, 0.1}, 0.4, maker.material(fresnel));
    maker.quad({-0.9, -0.9, -0.95}, {1.2, 0, 0}, {0, 1.4, 0}, maker.material(mirror()));
    return maker;
}

SceneMaker glassRoom() {
    SceneMaker maker = litRoom();
    MaterialDescription tinted = glass();
    tinted.transmission = Rgb(0.9f, 0.8f, 0.6f);
    maker.sphere({0.4, -0.5, 0.1}, 0.4, maker.material(tinted));
    maker.box({-0.7, -0.95, -0.5}, {-0.2, 0, 0}, maker.material(glass(1.3f)), false);
    return maker;
}

// A ball inside a shell, with air between; and a ball of other glass in a ball.
SceneMaker nestedGlassRoom() {
    SceneMaker maker = litRoom();
    maker.sphere({-0.4, -0.5, 0}, 0.45, maker.material(glass()));
    maker.sphere({-0.4, -0.5, 0}, 0.35, maker.material(glass(1 / 1.5f)));
    maker.sphere({-0.4, -0.5, 0}, 0.2, maker.diffuse(Rgb(0.6f, 0.6f, 0.1f)));
    maker.sphere({0.5, -0.5, 0.1}, 0.4, maker.material(glass()));
    maker.sphere({0.5, -0.5, 0.1}, 0.2, maker.material(glass(1.2f)));
    return maker;
}

// A mirror seen through glass, and the floor in that mirror.
SceneMaker mirrorBehindGlassRoom() {
    SceneMaker maker = litRoom();
    maker.quad({-0.8, -0.8, -0.9}, {1.6, 0, 0}, {0, 1.6, 0}, maker.material(mirror()));
    maker.box({-0.6, -0.7, 0.2}, {0.6, 0.5, 0.3}, maker.material(glass()), false);
    return maker;
}

// Surfaces that let a share of the light pass: a diffuse one, a glossy one and a mirror.
SceneMaker transparentRoom() {
    SceneMaker maker = litRoom();
    MaterialDescription sheet;
    sheet.diffuse = Rgb(0.8f, 0.6f, 0.3f);
    sheet.transparency = 0.5f;
    maker.quad({-0.8, 0.3, -0.8}, {1.1, 0, 0}, {0, 0, 1.4}, maker.material(sheet));
    MaterialDescription half = mirror();
    half.transparency = 0.4f;
    maker.quad({0.1, -0.9, 0.1}, {0.8, 0, 0.2}, {0, 1.1, 0}, maker.material(half));
    sheet.glossy = Rgb(0.2f);
    sheet.glossyExponent = 10;
    maker.sphere({-0.5, -0.6, 0}, 0.35, maker.material(sheet));
    return maker;
}

}  // namespace

std::string roomName(const ::testing::TestParamInfo<Room>& info) {
    std::string name = info.param.name;
    std::ranges::replace(name, ' ', '_');
    return name;
}

void PrintTo(const Room& room, std::ostream* out) {
    *out << room.name;
}

std::vector<Room> roomsOfEveryLobe() {
    return {{"diffuse", diffuseRoom()},
            {"glossy", glossyRoom()},
            {"mirror", mirrorRoom()},
            {"glass", glassRoom()},
            {"nested glass", nestedGlassRoom()},
            {"mirror behind glass", mirrorBehindGlassRoom()},
            {"partly transparent", transparentRoom()}};
}

}  // namespace pm::test
