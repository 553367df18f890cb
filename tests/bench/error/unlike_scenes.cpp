// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/error/unlike_scenes.h"

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "tests/support/rooms.h"
#include "tests/support/sky_picture.h"

namespace pm::bench {

namespace {

// A number in [0, 1) from a whole one: fractions of multiples of an irrational number.
double fraction(int i, double irrational) {
    return std::fmod(irrational * i, 1.0);
}
constexpr double kFirst = 0.7548776662, kSecond = 0.5698402910, kThird = 0.6180339887;

// Floor, three walls and ceiling of a room; the wall at x0 is left out.
void addRoom(test::SceneMaker& maker, const Vec3d& lo, const Vec3d& hi, std::uint32_t floor,
             std::uint32_t walls) {
    const Vec3d size = hi - lo;
    maker.quad({lo.x, lo.y, hi.z}, {size.x, 0, 0}, {0, 0, -size.z}, floor);
    maker.quad({lo.x, hi.y, lo.z}, {size.x, 0, 0}, {0, 0, size.z}, walls);
    maker.quad(lo, {size.x, 0, 0}, {0, size.y, 0}, walls);
    maker.quad({hi.x, lo.y, lo.z}, {0, 0, size.z}, {0, size.y, 0}, walls);
    maker.quad({hi.x, lo.y, hi.z}, {-size.x, 0, 0}, {0, size.y, 0}, walls);
}

// Bushes of small leaves in the sun, on the ground.
test::SceneMaker foliage() {
    test::SceneMaker maker;
    maker.quad({-4, 0, 4}, {8, 0, 0}, {0, 0, -8}, maker.diffuse({0.4f, 0.34f, 0.25f}));
    const auto leaf = maker.diffuse({0.25f, 0.45f, 0.12f});
    for (int bush = 0; bush < 3; ++bush) {
        TriangleMesh mesh;
        constexpr int kLeaves = 900;
        for (int i = 0; i < kLeaves; ++i) {
            const int n = bush * kLeaves + i;
            const double up = 2 * fraction(n, kFirst) - 1, turn = 6.2832 * fraction(n, kSecond);
            const double out = std::cbrt(fraction(n, kThird)), ring = std::sqrt(1 - up * up);
            const Vec3d at{-1.1 + 1.1 * bush + 0.55 * out * ring * std::cos(turn),
                           0.6 + 0.55 * out * up,
                           0.3 * (bush - 1) + 0.55 * out * ring * std::sin(turn)};
            const double a = 2.4 * n, b = 1.7 * n;
            const Vec3d along = Vec3d{std::cos(a), std::sin(b), std::sin(a)} * 0.06;
            const Vec3d across = Vec3d{-std::sin(a) * std::cos(b), 0.7, std::cos(a)} * 0.03;
            const auto first = static_cast<std::uint32_t>(mesh.positions.size());
            for (const Vec3d& corner : {at - along, at + across, at + along})
                mesh.positions.push_back(Vec3f(corner));
            mesh.triangles.push_back({first, first + 1, first + 2});
        }
        maker.mesh(std::move(mesh), leaf);
    }
    maker.sky({0.7f, 0.9f, 1.3f});
    maker.sun({-0.5, -1, -0.35}, {3.6f, 3.3f, 2.8f}, 0.005);
    maker.camera({0.4, 1.3, 3.2}, {0, 0.5, 0}, {0, 1, 0}, 40);
    return maker;
}

// A room whose only opening is a shutter: the sun comes in by nine slits.
test::SceneMaker slits() {
    test::SceneMaker maker;
    const auto plaster = maker.diffuse({0.72f, 0.7f, 0.66f});
    const auto wood = maker.diffuse({0.45f, 0.3f, 0.2f});
    addRoom(maker, {-1.5, 0, -1.5}, {1.5, 2.2, 1.5}, wood, plaster);
    constexpr int kSlits = 9;
    constexpr double kApart = 0.14, kOpen = 0.03;
    maker.quad({-1.5, 0, 1.5}, {0, 0, -3}, {0, 0.7, 0}, plaster);
    maker.quad({-1.5, 0.7, -0.6}, {0, 0, -0.9}, {0, 1.5, 0}, plaster);
    maker.quad({-1.5, 0.7, 1.5}, {0, 0, -0.9}, {0, 1.5, 0}, plaster);
    for (int i = 0; i <= kSlits; ++i) {
        const double y = 0.7 + kApart * i, top = i == kSlits ? 2.2 : y + kApart - kOpen;
        maker.quad({-1.5, y, 0.6}, {0, 0, -1.2}, {0, top - y, 0}, plaster);
    }
    maker.box({0.3, 0, -1.1}, {0.9, 0.6, -0.5}, wood, false);
    maker.sun({1, -0.75, -0.1}, {50.0f, 46.0f, 38.0f}, 0.005);
    maker.camera({1.2, 1.6, 1.3}, {-0.3, 0.5, -0.7}, {0, 1, 0}, 56);
    return maker;
}

// Height and slope of the water at a place.
std::array<double, 3> waveAt(double x, double z) {
    std::array<double, 3> wave{-0.12, 0, 0};
    for (int i = 0; i < 9; ++i) {
        const double k = 9 + 22 * fraction(i, kFirst), turn = 6.2832 * fraction(i + 1, kSecond);
        const double c = k * std::cos(turn), s = k * std::sin(turn);
        const double phase = c * x + s * z + 6.2832 * fraction(i, kThird);
        wave[0] += 0.06 / k * std::sin(phase);
        wave[1] += 0.06 * c / k * std::cos(phase);
        wave[2] += 0.06 * s / k * std::cos(phase);
    }
    return wave;
}

// A sheet of waves at y = -0.12 within |x|, |z| < half.
TriangleMesh waves(double half, std::uint32_t n) {
    TriangleMesh mesh;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i) {
            const double x = half * (2.0 * i / n - 1), z = half * (2.0 * j / n - 1);
            const auto [y, dx, dz] = waveAt(x, z);
            mesh.positions.push_back(Vec3f(Vec3d{x, y, z}));
            mesh.normals.push_back(Vec3f(normalize(Vec3d{-dx, 1, -dz})));
        }
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t a = j * (n + 1) + i, b = a + n + 1;
            mesh.triangles.push_back({a, b, b + 1});
            mesh.triangles.push_back({a, b + 1, a + 1});
        }
    mesh.normalIndices = mesh.triangles;
    return mesh;
}

// A tiled basin of rough water in the sun: filaments of light on its floor and walls.
test::SceneMaker water() {
    test::SceneMaker maker;
    const auto stone = maker.diffuse({0.6f, 0.56f, 0.5f}), tile = maker.diffuse(Rgb(0.7f));
    maker.quad({-1, -0.8, 1}, {2, 0, 0}, {0, 0, -2}, tile);
    maker.quad({-1, -0.8, -1}, {2, 0, 0}, {0, 0.8, 0}, tile);
    maker.quad({-1, -0.8, 1}, {0, 0, -2}, {0, 0.8, 0}, tile);
    maker.quad({1, -0.8, -1}, {0, 0, 2}, {0, 0.8, 0}, tile);
    maker.quad({1, -0.8, 1}, {-2, 0, 0}, {0, 0.8, 0}, tile);
    maker.quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -2}, stone);
    maker.quad({-3, 0, -1}, {6, 0, 0}, {0, 0, -2}, stone);
    maker.quad({-3, 0, 1}, {2, 0, 0}, {0, 0, -2}, stone);
    maker.quad({1, 0, 1}, {2, 0, 0}, {0, 0, -2}, stone);
    maker.mesh(waves(1.02, 120), maker.material(test::glass(1.33f)));
    maker.sky({0.25f, 0.32f, 0.45f});
    maker.sun({0.35, -1, -0.3}, {3.4f, 3.2f, 2.9f}, 0.01);
    maker.camera({0, 2.1, 2.6}, {0, -0.5, -0.1}, {0, 1, 0}, 40);
    return maker;
}

void addTextured(test::SceneMaker& maker, const Vec3d& p, const Vec3d& e0, const Vec3d& e1,
                 std::uint32_t material) {
    TriangleMesh mesh;
    for (const Vec3d& corner : {p, p + e0, p + e0 + e1, p + e1})
        mesh.positions.push_back(Vec3f(corner));
    mesh.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles = mesh.texcoordIndices = {{0, 1, 2}, {0, 2, 3}};
    maker.mesh(std::move(mesh), material);
}

// A room papered with a fine pattern, by the sky through one open side.
test::SceneMaker textures() {
    test::SceneMaker maker;
    maker.description.textures =
        std::make_shared<const test::SkyPicture>(256, 256, [](std::uint32_t x, std::uint32_t y) {
            const bool stripe = (x / 3 + y / 7) % 2 == 0, dot = (x * x + 3 * y * y) % 11 < 3;
            return stripe ? Rgb(0.75f, 0.6f, 0.3f) : dot ? Rgb(0.1f, 0.15f, 0.4f) : Rgb(0.5f);
        });
    MaterialDescription description;
    description.diffuse = Rgb(1.0f);
    description.diffuseTexture = 0;
    const auto paper = maker.material(description), white = maker.diffuse(Rgb(0.7f));
    addTextured(maker, {-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, paper);
    addTextured(maker, {-2, 0, -2}, {4, 0, 0}, {0, 2.4, 0}, paper);
    addTextured(maker, {2, 0, -2}, {0, 0, 4}, {0, 2.4, 0}, paper);
    addTextured(maker, {2, 0, 2}, {-4, 0, 0}, {0, 2.4, 0}, paper);
    maker.quad({-2, 2.4, -2}, {4, 0, 0}, {0, 0, 4}, white);
    maker.quad({-2, 0, 2}, {0, 0, -4}, {0, 0.8, 0}, white);
    maker.meshSphere({0.5, 0.45, -0.6}, 0.45, white, false, 16);
    maker.sky({3.0f, 3.4f, 4.0f});
    maker.camera({-0.6, 1.5, 1.8}, {0.5, 0.8, -1}, {0, 1, 0}, 58);
    return maker;
}

// Houses and trees by a square in the open.
test::SceneMaker outdoor() {
    test::SceneMaker maker;
    const auto ground = maker.diffuse({0.4f, 0.38f, 0.34f}),
               wall = maker.diffuse({0.7f, 0.6f, 0.45f});
    const auto roof = maker.diffuse({0.5f, 0.16f, 0.1f}),
               green = maker.diffuse({0.15f, 0.35f, 0.1f});
    maker.quad({-40, 0, 40}, {80, 0, 0}, {0, 0, -80}, ground);
    for (int i = 0; i < 6; ++i) {
        const double x = -7.5 + 3 * i, z = -5.5 - 1.2 * (i % 2), high = 2.2 + 0.7 * (i % 3);
        maker.box({x, 0, z - 3}, {x + 2.6, high, z}, wall, false);
        maker.box({x - 0.15, high, z - 3.2}, {x + 2.75, high + 0.25, z + 0.3}, roof, false);
        maker.box({x + 0.9, 0, z}, {x + 1.6, 1.5, z + 0.04}, roof, false);
    }
    for (int i = 0; i < 5; ++i) {
        const double x = -4.5 + 2.3 * i, z = -2.4 + 0.8 * (i % 3);
        maker.box({x - 0.08, 0, z - 0.08}, {x + 0.08, 0.9, z + 0.08}, roof, false);
        maker.meshSphere({x, 1.35, z}, 0.6, green, false, 12);
    }
    maker.sky({0.55f, 0.7f, 1.0f}, test::sunnySky());
    maker.camera({1.5, 2.2, 6}, {-0.3, 1.2, -4}, {0, 1, 0}, 46);
    return maker;
}

}  // namespace

std::vector<UnlikeScene> unlikeScenesByDay() {
    return {{"foliage", "bushes of small leaves in the sun", foliage()},
            {"slits", "a room by the sun through nine slits", slits()},
            {"water", "a basin of rough water in the sun", water(), false},
            {"textures", "a room papered with a fine pattern, by the sky", textures()},
            {"outdoor", "houses and trees under a sky with a sun", outdoor()}};
}

std::vector<UnlikeScene> unlikeScenes() {
    std::vector<UnlikeScene> scenes = unlikeScenesByLamps();
    for (UnlikeScene& scene : unlikeScenesByDay()) scenes.push_back(std::move(scene));
    return scenes;
}

}  // namespace pm::bench
