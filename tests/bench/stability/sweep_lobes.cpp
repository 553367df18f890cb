// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Lobes from broad to mirror, surfaces that lose next to nothing, long ways, and bent normals.
#include <cmath>
#include <numbers>

#include "tests/bench/stability/sweep.h"
#include "tests/bench/stability/sweep_look.h"
#include "tests/support/rooms.h"

namespace pm::bench {

namespace {

MaterialDescription lobe(double exponent, float reflectance) {
    MaterialDescription m = test::mirror(reflectance);
    m.glossyExponent = static_cast<float>(exponent);
    return m;
}

Sweep exponents(IntegratorKind integrator) {
    Sweep sweep{.kind = "lobes", .name = "exponent, in a furnace"};
    sweep.variant = nameOf(integrator);
    sweep.parameter = "exponent";
    sweep.values = {1, 3, 10, 30, 44.9, 45.1, 60, 100, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8};
    sweep.against = "what the lobe reflects of even light at right angles";
    sweep.measure = [=](double exponent, std::uint64_t seed) {
        test::SceneMaker maker;
        maker.box({-2, -2, -2}, {2, 2, 2}, maker.diffuse({}, Rgb(1.0f)), true);
        maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(lobe(exponent, 0.8f)));
        maker.camera({0, 0, 1.5}, {0, 0, 0}, {0, 1, 0}, 0.1);
        return look(maker, {integrator, seed, 16, 4}).beauty;
    };
    sweep.expected = [](double, std::uint64_t) { return static_cast<double>(0.8f); };
    return sweep;
}

// A ball with a lobe in a lit room.
test::SceneMaker roomWithALobe(const MaterialDescription& material) {
    test::SceneMaker maker = test::openRoom();
    test::ceilingLamp(maker, 0.6, Rgb(5.0f));
    maker.sphere({0, -0.4, 0}, 0.5, maker.material(material));
    return maker;
}

Sweep lobesInARoom() {
    Sweep sweep{.kind = "lobes", .name = "exponent, in a room", .variant = "photon"};
    sweep.parameter = "exponent";
    sweep.values = {1, 3, 10, 30, 44.9, 45.1, 60, 100, 1e3, 1e4, 1e5, 1e6};
    sweep.against = "path tracing";
    sweep.isLong = true;
    sweep.measure = [](double exponent, std::uint64_t seed) {
        return look(roomWithALobe(lobe(exponent, 0.8f)), {IntegratorKind::kPhoton, seed}).beauty;
    };
    sweep.expected = [](double exponent, std::uint64_t seed) {
        return look(roomWithALobe(lobe(exponent, 0.8f)), {IntegratorKind::kPath, seed, 16, 64})
            .beauty;
    };
    return sweep;
}

// A lobe, and at 1e31 a mirror, that shows a wall with a lamp in it, at an angle.
Sweep towardsMirror(IntegratorKind integrator, double degrees) {
    Sweep sweep{.kind = "lobes", .name = "narrow lobe and mirror"};
    sweep.variant = nameOf(integrator) + (degrees > 0 ? ", at 60 degrees" : "");
    sweep.parameter = "exponent";
    sweep.values = decades(3, 9);
    sweep.against = "a mirror";
    sweep.flatFrom = degrees > 0 ? 1e30 : 0.99e5;
    sweep.flatTo = 1.01e6;
    sweep.limit = degrees > 0
                      ? "the Phong lobe has a cosine that a mirror has not: it reflects 1/2 "
                        "at 60 degrees, however narrow it is."
                      : "a lobe's density goes by a float's cosine, 1 less some 6e-8, to "
                        "the power of the exponent: beyond 1e7 the weights of the two ways "
                        "to find a lamp do not add up to 1.";
    sweep.measure = [=](double exponent, std::uint64_t seed) {
        test::SceneMaker maker;
        const double of = exponent > 1e30 ? 0 : exponent, angle = degrees * std::numbers::pi / 180;
        maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(lobe(of, 0.8f)));
        maker.box({-9, -9, -9}, {9, 9, 9}, maker.diffuse({}, Rgb(1.0f)), true);
        const Vec3d away{-std::sin(angle), 0, std::cos(angle)}, up{0, 1, 0};
        maker.quad(away * 6 - up * 0.3 - cross(up, away) * 0.3, up * 0.6, cross(up, away) * 0.6,
                   maker.diffuse({}, Rgb(5.0f)));
        maker.camera({3 * std::sin(angle), 0, 3 * std::cos(angle)}, {0, 0, 0}, up, 10);
        return look(maker, {integrator, seed, 16, 4}).beauty;
    };
    sweep.wellAt = 1e31;
    return sweep;
}

Sweep albedos(IntegratorKind integrator) {
    Sweep sweep{.kind = "lobes", .name = "albedo, furnace", .variant = nameOf(integrator)};
    sweep.parameter = "1 less the albedo";
    sweep.values = {0.5, 0.1, 0.01, 1e-3, 1e-4};
    sweep.against = "all walls shine 1 less the albedo: 1";
    sweep.reported = "yocto-gl#1235";
    sweep.isLong = true;
    sweep.measure = [=](double lost, std::uint64_t seed) {
        test::SceneMaker maker;
        const auto kept = static_cast<float>(1 - lost);
        maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(kept), Rgb(1 - kept)), true);
        maker.camera({0.1, 0.2, 0.3}, {1, 0.4, -0.2}, {0, 1, 0}, 60);
        // The longer the paths, the fewer of them.
        const std::int32_t size = integrator == IntegratorKind::kPhoton ? 4 : lost < 5e-4 ? 8 : 16;
        return look(maker, {.integrator = integrator, .seed = seed, .size = size, .photons = 1000})
            .beauty;
    };
    sweep.expected = [](double, std::uint64_t) { return 1.0; };
    return sweep;
}

// A square tube of mirrors with a lamp at its end, seen at an angle.
Sweep tubes(IntegratorKind integrator, float reflectance) {
    Sweep sweep{.kind = "lobes", .name = "tube of mirrors"};
    sweep.variant = nameOf(integrator) + (reflectance < 1 ? ", 0.999" : ", lossless");
    sweep.parameter = "bounces";
    sweep.isLong = integrator == IntegratorKind::kPhoton;
    sweep.values = {1, 3, 10, 30, 100, 300, 1000};
    sweep.against = "reflectance to the power of the bounces";
    sweep.measure = [=](double bounces, std::uint64_t seed) {
        test::SceneMaker maker;
        const auto wall = maker.material(test::mirror(reflectance));
        const Vec3d way{0, 0, -bounces - 1};
        for (const double side : {-0.5, 0.5}) {
            maker.quad({side, -0.5, 1}, {0, 1, 0}, way, wall);
            maker.quad({-0.5, side, 1}, {1, 0, 0}, way, wall);
        }
        maker.quad({-0.5, -0.5, -bounces}, {1, 0, 0}, {0, 1, 0}, maker.diffuse({}, Rgb(1.0f)));
        maker.camera({0, 0, 0}, {1, 0, -1}, {0, 1, 0}, 1e-3);
        return look(maker, {integrator, seed, 16, 4}).beauty;
    };
    sweep.expected = [=](double bounces, std::uint64_t) {
        return std::pow(static_cast<double>(reflectance), bounces);
    };
    return sweep;
}

// A floor whose normals all lean, under a lamp and beside a wall.
Sweep bentNormals() {
    Sweep sweep{.kind = "lobes", .name = "bent normals", .variant = "photon"};
    sweep.parameter = "shading to geometric normal, degrees";
    sweep.values = {1, 10, 30, 50, 70, 80, 85, 89};
    sweep.against = "path tracing";
    sweep.reported = "pbrt-v3#78, mitsuba3#444";
    const auto room = [](double degrees) {
        test::SceneMaker maker;
        const double angle = degrees * std::numbers::pi / 180;
        maker.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, maker.diffuse(Rgb(0.7f)), 4);
        maker.bendNormals({std::sin(angle), std::cos(angle), 0});
        maker.quad({1, 0, -1}, {0, 0, 2}, {0, 2, 0}, maker.diffuse(Rgb(0.7f)));
        maker.quad({-0.3, 1.5, -0.3}, {0.6, 0, 0}, {0, 0, 0.6}, maker.diffuse({}, Rgb(10.0f)));
        maker.camera({-0.5, 1.2, 2.5}, {0.1, 0.3, 0}, {0, 1, 0}, 45);
        return maker;
    };
    sweep.measure = [=](double degrees, std::uint64_t seed) {
        return look(room(degrees), {IntegratorKind::kPhoton, seed, 16, 4}).beauty;
    };
    sweep.expected = [=](double degrees, std::uint64_t seed) {
        return look(room(degrees), {IntegratorKind::kPath, seed, 16, 64}).beauty;
    };
    return sweep;
}

// A ball of so few rings with smooth normals in sunlight from the side: rows of pixels where it
// grows brighter away from the light.
double brightenings(double rings, std::uint64_t seed) {
    test::SceneMaker maker;
    maker.meshSphere({}, 1, maker.diffuse(Rgb(0.8f)), false, static_cast<int>(rings));
    maker.sun({-1, 0, 0}, Rgb(3.0f), 0);
    maker.camera({0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 20);
    constexpr std::int32_t kSize = 48;
    const Seen seen = look(maker, {IntegratorKind::kPath, seed, kSize, 16});
    double rows = 0;
    for (std::int32_t y = kSize / 3; y < 2 * kSize / 3; ++y) {
        const double* row = seen.pixels.data() + static_cast<std::ptrdiff_t>(y) * kSize;
        bool grows = false;
        // From where the light is at right angles to the view on; 0.02 is pixels' noise.
        for (std::int32_t x = kSize / 3; x + 1 < 2 * kSize / 3; ++x)
            grows = grows || row[x] > row[x + 1] + 0.02;
        rows += grows ? 1 : 0;
    }
    return rows;
}

Sweep terminator() {
    Sweep sweep{.kind = "lobes", .name = "coarse ball with smooth normals", .variant = "path"};
    sweep.parameter = "rings of quads";
    sweep.values = {4, 8, 16, 32, 64};
    sweep.against = "no row of pixels that grows brighter away from the sun";
    sweep.reported = "mitsuba3#885, appleseed#2736, ospray#75";
    sweep.isCount = true;
    sweep.measure = brightenings;
    return sweep;
}

}  // namespace

std::vector<Sweep> lobeSweeps() {
    std::vector<Sweep> sweeps;
    for (const IntegratorKind integrator : kBoth) sweeps.push_back(exponents(integrator));
    sweeps.push_back(lobesInARoom());
    for (const IntegratorKind integrator : kBoth)
        for (const double degrees : {0.0, 60.0})
            sweeps.push_back(towardsMirror(integrator, degrees));
    for (const IntegratorKind integrator : kBoth) sweeps.push_back(albedos(integrator));
    for (const IntegratorKind integrator : kBoth)
        for (const float reflectance : {0.999f, 1.0f})
            sweeps.push_back(tubes(integrator, reflectance));
    sweeps.push_back(bentNormals());
    sweeps.push_back(terminator());
    return sweeps;
}

}  // namespace pm::bench
