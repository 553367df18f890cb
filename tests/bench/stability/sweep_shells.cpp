// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Surfaces close to each other, triangles of bad shape, and rays through edges and vertices.
#include <cmath>

#include "integrator/scene/scene.h"
#include "tests/bench/stability/sweep.h"
#include "tests/bench/stability/sweep_look.h"
#include "tests/support/rooms.h"
#include "tests/support/statistics.h"

namespace pm::bench {

namespace {

const std::vector<double> kThin = decades(-1, -7);

// A closed box of width 2 in a lit room, its walls of a thickness, inwards from outside.
test::SceneMaker boxInARoom(double thickness) {
    test::SceneMaker maker;
    const auto white = maker.diffuse(Rgb(0.8f));
    maker.box({-4, -1.5, -4}, {4, 4, 4}, white, true);
    maker.quad({-1, 3.9, -1}, {2, 0, 0}, {0, 0, 2}, maker.diffuse({}, Rgb(20.0f)));
    maker.box({-1, -1, -1}, {1, 1, 1}, white, false);
    const double in = 1 - thickness;
    maker.box({-in, -in, -in}, {in, in, in}, white, true);
    return maker;
}

Sweep leaks(IntegratorKind integrator) {
    Sweep sweep{.kind = "shells", .name = "leaks into a closed box"};
    sweep.variant = nameOf(integrator);
    sweep.parameter = "thickness of its walls, half widths";
    sweep.values = kThin;
    sweep.against = "black: pixels that show light";
    sweep.flatFrom = 0.99e-6;
    sweep.limit = "walls as thin as one rounding of their corners let paths through.";
    sweep.isCount = true;
    sweep.measure = [=](double thickness, std::uint64_t seed) {
        test::SceneMaker maker = boxInARoom(thickness);
        maker.camera({0.5, 0.6, 0.7}, {-0.4, -0.5, -0.6}, {0, 1, 0}, 100);
        return look(maker, {integrator, seed}).countOff(0);
    };
    return sweep;
}

Sweep outside(IntegratorKind integrator) {
    Sweep sweep{.kind = "shells", .name = "outside of thin walls"};
    sweep.variant = nameOf(integrator);
    sweep.parameter = "thickness of a box's walls, half widths";
    sweep.values = kThin;
    sweep.against = "the same with walls of 0.5";
    sweep.reported = "mitsuba#145";
    sweep.measure = [=](double thickness, std::uint64_t seed) {
        test::SceneMaker maker = boxInARoom(thickness);
        maker.camera({2.5, 1.8, 3}, {0, 0.1, 0}, {0, 1, 0}, 50);
        return look(maker, {integrator, seed}).beauty;
    };
    sweep.wellAt = 0.5;
    return sweep;
}

// Glass shells in a room that shines evenly can't be seen.
test::SceneMaker shellsInAFurnace(double thickness, int shells) {
    test::SceneMaker maker;
    maker.box({-2, -2, -2}, {2, 2, 2}, maker.diffuse({}, Rgb(1.0f)), true);
    MaterialDescription glass = test::glass();
    glass.priority = 1;  // as the air's: the smaller body is there
    const auto outer = maker.material(glass);
    const auto inner = maker.material(test::air());
    for (int i = 0; i < shells; ++i) {
        maker.sphere({}, 1 - 2 * i * thickness, outer);
        maker.sphere({}, 1 - (2 * i + 1) * thickness, inner);
    }
    maker.camera({0.3, 0.4, 1.7}, {0, 0, 0}, {0, 1, 0}, 60);
    return maker;
}

Sweep glassShells(IntegratorKind integrator, int shells) {
    Sweep sweep{.kind = "shells", .name = "nested glass shells in a furnace"};
    sweep.variant = nameOf(integrator) + ", " + std::to_string(shells);
    sweep.parameter = "thickness and distance of the shells, radii";
    sweep.values = kThin;
    if (shells > 1) sweep.values = {0.05, 1e-3, 1e-5, 1e-6, 1e-7};
    sweep.isLong = integrator == IntegratorKind::kPhoton && shells > 1;
    sweep.against = "invisible: 1";
    sweep.flatFrom = 0.99e-6;
    sweep.limit =
        "a body of glass whose two sides are round and closer than rays can start between "
        "swallows light.";
    sweep.measure = [=](double thickness, std::uint64_t seed) {
        return look(shellsInAFurnace(thickness, shells), {integrator, seed}).beauty;
    };
    sweep.expected = [](double, std::uint64_t) { return 1.0; };
    return sweep;
}

// Pixels of a finer frame that are not 1 there: single samples.
Sweep shellSpecks() {
    Sweep sweep = glassShells(IntegratorKind::kPath, 3);
    sweep.name = "specks of nested glass shells";
    sweep.against = "no pixel of 4096, of 4 samples, that is not 1";
    sweep.flatFrom = 0.99e-2;
    sweep.limit = "a ray along the rim may miss one of two surfaces that are close.";
    sweep.isCount = true;
    sweep.expected = {};
    sweep.measure = [](double thickness, std::uint64_t seed) {
        return look(shellsInAFurnace(thickness, 3), {IntegratorKind::kPath, seed, 64}).countOff(1);
    };
    return sweep;
}

// A grey sheet over a floor, a wall and a lamp; the floor comes closer from below.
test::SceneMaker sheetOverAFloor(double gap, Rgb shining) {
    test::SceneMaker maker;
    const auto grey = maker.diffuse(Rgb(0.5f));
    maker.quad({-1, -gap, 1}, {2, 0, 0}, {0, 0, -2}, maker.diffuse(Rgb(0.5f), shining));
    maker.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, grey);
    maker.quad({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}, grey);
    maker.camera({0.2, 1.2, 1.8}, {0, 0.1, -0.1}, {0, 1, 0}, 40);
    return maker;
}

Sweep sheets(IntegratorKind integrator) {
    Sweep sweep{.kind = "shells", .name = "a sheet over a floor", .variant = nameOf(integrator)};
    sweep.parameter = "gap, half widths (1e-30: coincident)";
    sweep.values = kThin;
    sweep.values.push_back(1e-30);
    sweep.against = "the same with the floor 0.5 below";
    sweep.measure = [=](double gap, std::uint64_t seed) {
        test::SceneMaker maker = sheetOverAFloor(gap, {});
        maker.quad({-0.3, 1.9, -0.3}, {0.6, 0, 0}, {0, 0, 0.6}, maker.diffuse({}, Rgb(10.0f)));
        return look(maker, {integrator, seed}).beauty;
    };
    sweep.wellAt = 0.5;
    return sweep;
}

Sweep hiddenFloor(IntegratorKind integrator) {
    Sweep sweep{.kind = "shells", .name = "a shining floor under a sheet"};
    sweep.variant = nameOf(integrator);
    sweep.parameter = "gap, half widths";
    sweep.values = kThin;
    sweep.against = "black: pixels of the sheet that show light";
    sweep.flatFrom = 0.99e-5;
    sweep.limit =
        "surfaces so close to each other are met as if in one plane, and either may be "
        "the one that is seen.";
    sweep.isCount = true;
    sweep.measure = [=](double gap, std::uint64_t seed) {
        test::SceneMaker maker = sheetOverAFloor(gap, Rgb(100.0f));
        maker.camera({0.1, 0.2, 0.8}, {0, 0, 0}, {0, 1, 0}, 10);
        return look(maker, {integrator, seed}).countOff(0);
    };
    return sweep;
}

// Of 20,000 rays from within a closed mesh to its vertices, or to places on its edges, those that
// meet nothing.
double pinholes(const test::SceneMaker& maker, const Vec3d& from, bool toVertices,
                std::uint64_t seed) {
    const auto scene = maker.build();
    const auto& instance = maker.description.instances.front();
    const auto& mesh = *std::get<std::shared_ptr<const TriangleMesh>>(instance.shape);
    const Transform& t = instance.transform;
    const auto world = [&](std::uint32_t corner) {
        const Vec3d p(mesh.positions[corner]);
        return Vec3d{t[0] * p.x, t[5] * p.y, t[10] * p.z};
    };
    test::Random random(seed);
    int missed = 0;
    for (int i = 0; i < 20'000; ++i) {
        const auto triangle = static_cast<std::size_t>(static_cast<double>(random.next()) *
                                                       static_cast<double>(mesh.triangles.size()));
        const auto& corners = mesh.triangles[triangle];
        const auto first = static_cast<std::size_t>(i % 3);
        // The lower pole's vertices are not quite in one place.
        if (mesh.positions[corners[first]].y < -0.999f * std::abs(mesh.positions[0].y)) continue;
        const Vec3d a = world(corners[first]), b = world(corners[(first + 1) % 3]);
        const double along = toVertices ? 0 : 0.02 + 0.96 * static_cast<double>(random.next());
        const Vec3d way = a + (b - a) * along - from;
        Surface surface;
        missed +=
            !scene->intersect({Vec3f(from - scene->centre()), Vec3f(normalize(way))}, surface);
    }
    return missed;
}

Sweep pinholeSweep(const std::string& of, const std::string& parameter, bool toVertices) {
    Sweep sweep{.kind = "shells", .name = "pinholes, " + of, .parameter = parameter};
    sweep.variant = toVertices ? "vertices" : "edges";
    sweep.against = "no ray of 20,000 that meets nothing";
    sweep.reported = "embree#174";
    sweep.isCount = true;
    return sweep;
}

std::vector<Sweep> pinholeSweeps(bool toVertices) {
    Sweep fine = pinholeSweep("a fine ball", "rings of quads", toVertices);
    fine.values = {2, 4, 16, 64, 256};
    fine.measure = [=](double rings, std::uint64_t seed) {
        test::SceneMaker maker;
        maker.meshSphere({}, 1, maker.diffuse({}), true, static_cast<int>(rings));
        return pinholes(maker, {0.1, 0.05, -0.07}, toVertices, seed);
    };
    Sweep needles = pinholeSweep("needles", "a ball's height, radii", toVertices);
    needles.values = decades(0, -7);
    needles.measure = [=](double height, std::uint64_t seed) {
        test::SceneMaker maker;
        maker.meshSphere({}, 1, maker.diffuse({}), true, 24);
        maker.description.instances.back().transform[5] = height;
        return pinholes(maker, {0.1, 0, -0.07}, toVertices, seed);
    };
    Sweep huge =
        pinholeSweep("huge triangles", "a ball's radius, widths of what is in it", toVertices);
    huge.values = decades(0, 9);
    huge.measure = [=](double radius, std::uint64_t seed) {
        test::SceneMaker maker;
        maker.meshSphere({}, radius, maker.diffuse({}), true, 8);
        const Vec3d at = Vec3d{0.3, 0.2, 0.1} * radius;
        maker.meshSphere(at, 0.5, maker.diffuse({}), false, 8);
        return pinholes(maker, at + Vec3d{0, 0.1, 0.7}, toVertices, seed);
    };
    if (toVertices) {
        fine.flatTo = 16;
        needles.flatFrom = 0.99;
        fine.limit = needles.limit =
            "a ray aimed at a vertex to the last bit may pass between the triangles around it.";
    }
    return {fine, needles, huge};
}

// A shining sliver, seen from so little above its plane: light beside the strip that it covers.
double streaks(double angle, std::uint64_t seed) {
    test::SceneMaker maker;
    const auto lamp = maker.diffuse({}, Rgb(1.0f));
    maker.polygon({{0, 0, 0}, {11.2, 0, 0}, {9.7, 0, 1.4}}, lamp);
    maker.polygon({{0, 0, 0}, {9.7, 0, 1.4}, {11.2, 0, 0}}, lamp);
    const double distance = 40;
    maker.camera({7, distance * std::sin(angle), distance * std::cos(angle)}, {7, 0, 0.5},
                 {0, 1, 0}, 20);
    constexpr std::int32_t kSize = 64;
    const Seen seen = look(maker, {IntegratorKind::kPath, seed, kSize});
    // Of the height of the frame, and a pixel.
    const double half = 1.4 * std::sin(angle) / (distance * std::tan(kPi / 18)) * kSize / 2 + 1.5;
    double off = 0;
    for (std::int32_t y = 0; y < kSize; ++y)
        for (std::int32_t x = 0; x < kSize; ++x)
            off += std::abs(y + 0.5 - kSize / 2) > half &&
                           seen.pixels[static_cast<std::size_t>(y * kSize + x)] > 0
                       ? 1
                       : 0;
    return off;
}

Sweep slivers() {
    Sweep sweep{.kind = "shells", .name = "a sliver at a grazing angle", .variant = "path"};
    sweep.parameter = "angle to its plane, radians";
    sweep.values = decades(-1, -7);
    sweep.values.push_back(1e-8);
    sweep.against = "no light beside it";
    sweep.reported = "embree#387";
    sweep.isCount = true;
    sweep.measure = [](double angle, std::uint64_t seed) {
        return streaks(angle > 1e-8 ? angle : 0, seed);
    };
    return sweep;
}

// What stands on a ground so large, in sunlight.
Sweep hugeGround(IntegratorKind integrator) {
    Sweep sweep{.kind = "shells", .name = "a huge ground", .variant = nameOf(integrator)};
    sweep.parameter = "its side, sizes of what stands on it";
    sweep.values = decades(3, 9);
    sweep.against = "the same on a ground of side 1000";
    sweep.reported = "embree#416, mitsuba2#171";
    sweep.measure = [=](double side, std::uint64_t seed) {
        test::SceneMaker maker;
        const auto grey = maker.diffuse(Rgb(0.5f));
        const double half = side / 2;
        maker.quad({-half, 0, half}, {side, 0, 0}, {0, 0, -side}, grey);
        maker.box({-0.5, 0, -0.5}, {0.5, 1, 0.5}, grey, false);
        maker.sun({-1, -2, -0.5}, Rgb(3.0f), 0.01);
        maker.camera({2, 4, 3}, {0, 0.3, 0}, {0, 1, 0}, 30);
        return look(maker, {integrator, seed}).beauty;
    };
    sweep.wellAt = 1000;
    return sweep;
}

}  // namespace

std::vector<Sweep> shellSweeps() {
    std::vector<Sweep> sweeps;
    for (const auto& make : {leaks, outside, sheets, hiddenFloor, hugeGround})
        for (const IntegratorKind integrator : kBoth) sweeps.push_back(make(integrator));
    for (const IntegratorKind integrator : kBoth)
        for (const int shells : {1, 5}) sweeps.push_back(glassShells(integrator, shells));
    sweeps.push_back(shellSpecks());
    sweeps.push_back(slivers());
    std::vector<Sweep> edges = pinholeSweeps(false), vertices = pinholeSweeps(true);
    for (std::size_t i = 0; i < edges.size(); ++i) {
        sweeps.push_back(std::move(edges[i]));
        sweeps.push_back(std::move(vertices[i]));
    }
    return sweeps;
}

}  // namespace pm::bench
