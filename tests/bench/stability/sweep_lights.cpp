// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Lamps small and large, bright and dim, edge-on, touched, around the camera, and many.
#include <cmath>
#include <numbers>

#include "tests/bench/stability/sweep.h"
#include "tests/bench/stability/sweep_look.h"
#include "tests/support/rooms.h"

namespace pm::bench {

namespace {

constexpr double kPi = std::numbers::pi;

using Corners = std::vector<Vec3d>;

Corners squareAt(double height, double side) {
    const double h = side / 2;
    return {{-h, height, -h}, {h, height, -h}, {h, height, h}, {-h, height, h}};
}

// A white floor around the origin, of which a camera sees next to nothing but that.
test::SceneMaker floorSeenAtTheOrigin(double eyeHeight = 0.9) {
    test::SceneMaker maker;
    maker.quad({-50, 0, 50}, {100, 0, 0}, {0, 0, -100}, maker.diffuse(Rgb(1.0f)));
    maker.camera({0, eyeHeight, 0}, {0, 0, 0}, {0, 0, -1}, 0.1);
    return maker;
}

// What the floor reflects of a polygon of that radiance.
double floorUnder(const Corners& lamp, double radiance) {
    return radiance * polygonIrradiance(lamp, {0, 1, 0}) / kPi;
}

double directOf(const test::SceneMaker& maker, IntegratorKind integrator, std::uint64_t seed) {
    return look(maker, {.integrator = integrator, .seed = seed, .size = 16, .passes = 4}).direct;
}

Sweep sizes(IntegratorKind integrator) {
    Sweep sweep{.kind = "lights", .name = "size at equal power", .variant = nameOf(integrator)};
    sweep.parameter = "lamp's side over its height";
    sweep.values = decades(-6, 3);
    sweep.against = "Lambert's formula";
    sweep.reported = "pbrt-v4#211";
    const auto radiance = [](double side) { return 1 / (kPi * side * side); };
    sweep.measure = [=](double side, std::uint64_t seed) {
        test::SceneMaker maker = floorSeenAtTheOrigin();
        maker.polygon(squareAt(1, side),
                      maker.diffuse({}, Rgb(static_cast<float>(radiance(side)))));
        return directOf(maker, integrator, seed);
    };
    sweep.expected = [=](double side, std::uint64_t) {
        return floorUnder(squareAt(1, side), radiance(side));
    };
    return sweep;
}

Sweep globes(IntegratorKind integrator) {
    Sweep sweep{.kind = "lights", .name = "globe at equal power", .variant = nameOf(integrator)};
    sweep.parameter = "lamp's radius over its height";
    sweep.values = decades(-6, -1);
    sweep.values.push_back(0.5);
    sweep.values.push_back(0.9);
    sweep.against = "a globe's closed form";
    sweep.measure = [=](double radius, std::uint64_t seed) {
        test::SceneMaker maker = floorSeenAtTheOrigin(0.05);
        maker.sphere({0, 1, 0}, radius,
                     maker.diffuse({}, Rgb(static_cast<float>(1 / (radius * radius)))));
        return directOf(maker, integrator, seed);
    };
    sweep.expected = [](double, std::uint64_t) { return 1.0; };
    return sweep;
}

Sweep radiances(IntegratorKind integrator) {
    Sweep sweep{.kind = "lights", .name = "radiance", .variant = nameOf(integrator)};
    sweep.parameter = "radiance of a lamp";
    sweep.values = {1e-6, 1e-3, 1, 1e3, 1e6, 1e9};
    sweep.against = "the room at radiance 1, times it";
    sweep.measure = [=](double radiance, std::uint64_t seed) {
        test::SceneMaker maker = test::openRoom();
        test::ceilingLamp(maker, 0.4, Rgb(static_cast<float>(radiance)));
        maker.sphere({0.3, -0.6, 0}, 0.3, maker.material(test::glass()));
        return look(maker, {integrator, seed}).beauty / radiance;
    };
    sweep.wellAt = 1;
    return sweep;
}

// A lamp beside the receiver that turns its edge to it.
Corners edgeOn(double angle) {
    const Vec3d foot{0.3, 0.2, -0.3}, along{0, 0, 0.6};
    const Vec3d up{std::cos(angle + std::atan2(0.2, 0.3)), std::sin(angle + std::atan2(0.2, 0.3)),
                   0};
    Corners corners = {foot, foot + along, foot + along + up * 0.5, foot + up * 0.5};
    for (Vec3d& p : corners) p = Vec3d(Vec3f(p));  // as the mesh has them
    return corners;
}

Sweep edges(IntegratorKind integrator) {
    Sweep sweep{.kind = "lights", .name = "edge-on", .variant = nameOf(integrator)};
    sweep.parameter = "angle of the lamp's plane to the receiver, radians";
    sweep.flatFrom = 0.99e-4;
    sweep.limit = "corners are floats about the scene's centre, and their rounding turns the lamp.";
    sweep.values = decades(-1, -7);
    sweep.against = "Lambert's formula";
    sweep.reported = "pbrt-v4#134";
    sweep.measure = [=](double angle, std::uint64_t seed) {
        test::SceneMaker maker = floorSeenAtTheOrigin();
        // So narrow that the floor's points see it at the same angle.
        maker.camera({0, 0.9, 0}, {0, 0, 0}, {0, 0, -1}, 0.5 * angle);
        maker.polygon(edgeOn(angle), maker.diffuse({}, Rgb(static_cast<float>(1 / angle))));
        return directOf(maker, integrator, seed);
    };
    sweep.expected = [](double angle, std::uint64_t) {
        return floorUnder(edgeOn(angle), 1 / angle);
    };
    return sweep;
}

// A camera between a floor and a lamp that all but lies on it.
Sweep touching(IntegratorKind integrator) {
    Sweep sweep{.kind = "lights", .name = "lamp close over a floor"};
    sweep.variant = nameOf(integrator);
    sweep.parameter = "height over its side";
    sweep.flatFrom = integrator == IntegratorKind::kPhoton ? 0.99e-4 : 0;
    sweep.limit =
        "rays of gather points start 4e-6 of the scene's radius above the surface, beyond "
        "a lamp that is closer, and its direct light is lost.";
    sweep.values = decades(0, -7);
    sweep.against = "Lambert's formula";
    sweep.measure = [=](double height, std::uint64_t seed) {
        test::SceneMaker maker;
        maker.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, maker.diffuse(Rgb(1.0f)));
        maker.camera({0, height / 2, 0}, {0, 0, 0}, {0, 0, -1}, 0.1);
        maker.polygon(squareAt(height, 1), maker.diffuse({}, Rgb(1.0f)));
        return directOf(maker, integrator, seed);
    };
    sweep.expected = [](double height, std::uint64_t) {
        return floorUnder(squareAt(height, 1), 1);
    };
    return sweep;
}

// A lamp that stands on the floor, seen beside its foot.
Corners standing(double distance) {
    return {{distance, 0, -0.5}, {distance, 0, 0.5}, {distance, 1, 0.5}, {distance, 1, -0.5}};
}

Sweep foot(IntegratorKind integrator) {
    Sweep sweep{.kind = "lights", .name = "beside a lamp's foot", .variant = nameOf(integrator)};
    sweep.parameter = "distance over its height";
    sweep.values = decades(0, -7);
    sweep.against = "Lambert's formula";
    sweep.measure = [=](double distance, std::uint64_t seed) {
        test::SceneMaker maker = floorSeenAtTheOrigin();
        maker.camera({0, 0.9, 0}, {0, 0, 0}, {0, 0, -1}, 1 * std::min(0.1, distance));
        const auto shining = maker.diffuse({}, Rgb(1.0f));
        const Corners lamp = standing(distance);
        maker.polygon(lamp, shining);
        return directOf(maker, integrator, seed);
    };
    sweep.expected = [](double distance, std::uint64_t) {
        return floorUnder(standing(distance), 1);
    };
    return sweep;
}

// A camera in a closed lamp with a grey ball.
Sweep inside(IntegratorKind integrator) {
    Sweep sweep{.kind = "lights", .name = "camera in a lamp", .variant = nameOf(integrator)};
    sweep.parameter = "lamp's size";
    sweep.values = decades(-6, 6);
    sweep.against = "all shines alike: 1";
    sweep.measure = [=](double size, std::uint64_t seed) {
        test::SceneMaker maker;
        const auto grey = maker.diffuse(Rgb(0.5f), Rgb(0.5f));
        maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse({}, Rgb(1.0f)), true);
        maker.sphere({0.2, 0, -0.3}, 0.4, grey);
        maker.camera({0, 0.1, 0.9}, {0, 0, 0}, {0, 1, 0}, 60);
        return look(placed(maker, size, {}), {integrator, seed}).beauty;
    };
    sweep.expected = [](double, std::uint64_t) { return 1.0; };
    return sweep;
}

Sweep numbers(IntegratorKind integrator) {
    Sweep sweep{.kind = "lights", .name = "number", .variant = nameOf(integrator)};
    sweep.parameter = "triangles of a lamp";
    for (const double n : {1, 3, 10, 32, 100, 224}) sweep.values.push_back(2 * n * n);
    sweep.against = "Lambert's formula";
    sweep.measure = [=](double triangles, std::uint64_t seed) {
        test::SceneMaker maker = floorSeenAtTheOrigin();
        maker.quad({-0.5, 1, -0.5}, {1, 0, 0}, {0, 0, 1}, maker.diffuse({}, Rgb(1.0f)),
                   static_cast<std::uint32_t>(std::lround(std::sqrt(triangles / 2))));
        return directOf(maker, integrator, seed);
    };
    sweep.expected = [](double, std::uint64_t) { return floorUnder(squareAt(1, 1), 1); };
    return sweep;
}

// A hundred lamps of which every second is dimmer, and a wall that leaves those to be seen alone.
Sweep unequal(IntegratorKind integrator, bool dimAlone) {
    Sweep sweep{.kind = "lights", .name = "unequal lamps"};
    sweep.variant = nameOf(integrator) + (dimAlone ? ", the dim alone" : ", all");
    sweep.parameter = "radiance of the bright over that of the dim";
    sweep.values = decades(0, 9);
    sweep.against = "Lambert's formula";
    const auto lamp = [](int i, int j) {
        const Vec3d p{-1 + 0.2 * i, 1, -1 + 0.2 * j};
        return Corners{p, p + Vec3d{0.15, 0, 0}, p + Vec3d{0.15, 0, 0.15}, p + Vec3d{0, 0, 0.15}};
    };
    const auto isBright = [](int i, int) { return i < 5; };
    sweep.measure = [=](double ratio, std::uint64_t seed) {
        test::SceneMaker maker = floorSeenAtTheOrigin();
        const auto bright = maker.diffuse({}, Rgb(1.0f));
        const auto dim = maker.diffuse({}, Rgb(static_cast<float>(1 / ratio)));
        for (int i = 0; i < 10; ++i)
            for (int j = 0; j < 10; ++j) maker.polygon(lamp(i, j), isBright(i, j) ? bright : dim);
        if (dimAlone)
            maker.quad({-0.024, 0, -50}, {0, 0, 100}, {0, 2, 0}, maker.diffuse(Rgb(0.0f)));
        return directOf(maker, integrator, seed) * (dimAlone ? ratio : 1);
    };
    sweep.expected = [=](double ratio, std::uint64_t) {
        double sum = 0;
        for (int i = 0; i < 10; ++i)
            for (int j = 0; j < 10; ++j)
                if (!dimAlone || !isBright(i, j))
                    sum += floorUnder(lamp(i, j), isBright(i, j) ? 1 : dimAlone ? 1 : 1 / ratio);
        return sum;
    };
    return sweep;
}

}  // namespace

std::vector<Sweep> lightSweeps() {
    std::vector<Sweep> sweeps;
    for (const auto& make : {sizes, globes, radiances, edges, touching, foot, inside, numbers})
        for (const IntegratorKind integrator : kBoth) sweeps.push_back(make(integrator));
    for (const IntegratorKind integrator : kBoth)
        for (const bool dimAlone : {false, true}) sweeps.push_back(unequal(integrator, dimAlone));
    return sweeps;
}

}  // namespace pm::bench
