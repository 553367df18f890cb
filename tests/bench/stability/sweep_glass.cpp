// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Glass at grazing and critical angles, of any index, in chains, and with water in it.
#include <cmath>
#include <numbers>

#include "tests/bench/stability/sweep.h"
#include "tests/bench/stability/sweep_look.h"
#include "tests/support/rooms.h"

namespace pm::bench {

namespace {

constexpr double kPi = std::numbers::pi;

// Of so many surfaces one behind the other that reflect r each, all ways to and fro included.
double throughSurfaces(double count, double r) {
    return (1 - r) / (1 + (count - 1) * r);
}

Sweep grazing(IntegratorKind integrator) {
    Sweep sweep{.kind = "glass", .name = "grazing angle", .variant = nameOf(integrator)};
    sweep.parameter = "angle to a slab, degrees";
    sweep.values = {90, 30, 10, 3, 1, 0.3, 0.1, 0.03, 0.01};
    sweep.against = "Fresnel's formulas for a slab";
    sweep.measure = [=](double degrees, std::uint64_t seed) {
        test::SceneMaker maker;
        const double angle = degrees * kPi / 180, s = 200;
        maker.quad({-s, -s, -0.11}, {2 * s, 0, 0}, {0, 2 * s, 0}, maker.diffuse({}, Rgb(1.0f)));
        maker.box({-s, -s, -0.1}, {s, s, 0}, maker.material(test::glass()), false);
        maker.camera({5 * std::cos(angle), 0, 5 * std::sin(angle)}, {0, 0, 0}, {0, 1, 0},
                     1e-3 * degrees);
        return look(maker, {integrator, seed, 16, manyPasses(integrator)}).beauty;
    };
    sweep.expected = [](double degrees, std::uint64_t) {
        return throughSurfaces(2, fresnel(1.5, std::sin(degrees * kPi / 180)));
    };
    return sweep;
}

Sweep critical(IntegratorKind integrator) {
    Sweep sweep{.kind = "glass", .name = "critical angle", .variant = nameOf(integrator)};
    sweep.parameter = "below the critical angle by, radians";
    sweep.values = decades(-1, -6);
    sweep.against = "n^2 (1 - R), seen from within";
    sweep.flatFrom = 0.99e-2;
    sweep.limit =
        "directions are floats, whose rounding of 6e-8 is a share of the angle that is left; "
        "what is let through goes by its root.";
    const double index = 1.5;
    const auto angleAt = [=](double below) { return std::asin(1 / index) - below; };
    sweep.measure = [=](double below, std::uint64_t seed) {
        test::SceneMaker maker;
        maker.box({-9, -9, -9}, {9, 9, 9}, maker.diffuse({}, Rgb(1.0f)), true);
        maker.box({-5, -5, -5}, {5, 5, 0}, maker.material(test::glass()), false);
        // What is reflected ends in a black tub.
        const auto black = maker.diffuse({});
        maker.quad({-4, -4, -4}, {8, 0, 0}, {0, 8, 0}, black);
        maker.quad({-4, -4, -4}, {0, 8, 0}, {0, 0, 3.9}, black);
        maker.quad({4, -4, -4}, {0, 8, 0}, {0, 0, 3.9}, black);
        const double angle = angleAt(below);
        maker.camera({-std::sin(angle), 0, -std::cos(angle)}, {0, 0, 0}, {0, 1, 0},
                     1e-3 * below * 180 / kPi);
        return look(maker, {integrator, seed, 16, manyPasses(integrator)}).beauty;
    };
    sweep.expected = [=](double below, std::uint64_t) {
        const double sine = index * std::sin(angleAt(below));
        return index * index * (1 - fresnel(index, std::sqrt(1 - sine * sine)));
    };
    return sweep;
}

Sweep indices(IntegratorKind integrator) {
    Sweep sweep{.kind = "glass", .name = "index, ball in a furnace"};
    sweep.variant = nameOf(integrator);
    sweep.parameter = "index less 1";
    sweep.values = decades(-6, -1);
    for (const double more : {0.5, 1.0, 2.0, 3.0}) sweep.values.push_back(more);
    sweep.against = "invisible: 1";
    sweep.reported = "yocto-gl#452, ChameleonRT#3";
    sweep.measure = [=](double more, std::uint64_t seed) {
        test::SceneMaker maker;
        maker.box({-2, -2, -2}, {2, 2, 2}, maker.diffuse({}, Rgb(1.0f)), true);
        maker.sphere({}, 1, maker.material(test::glass(static_cast<float>(1 + more))));
        maker.camera({0.3, 0.4, 1.7}, {0, 0, 0}, {0, 1, 0}, 60);
        return look(maker, {integrator, seed}).beauty;
    };
    sweep.expected = [](double, std::uint64_t) { return 1.0; };
    return sweep;
}

Sweep slabIndices(IntegratorKind integrator) {
    Sweep sweep = indices(integrator);
    sweep.name = "index, slab";
    sweep.against = "2 n / (n^2 + 1)";
    sweep.measure = [=](double more, std::uint64_t seed) {
        test::SceneMaker maker;
        maker.quad({-5, -5, -2}, {10, 0, 0}, {0, 10, 0}, maker.diffuse({}, Rgb(1.0f)));
        maker.box({-4, -4, -1}, {4, 4, -0.9},
                  maker.material(test::glass(static_cast<float>(1 + more))), false);
        maker.camera({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.01);
        return look(maker, {integrator, seed, 16, manyPasses(integrator)}).beauty;
    };
    sweep.expected = [](double more, std::uint64_t) {
        const auto n = static_cast<double>(static_cast<float>(1 + more));
        return 2 * n / (n * n + 1);
    };
    return sweep;
}

// A lamp within a block of glass, seen from straight above: its radiance is spread over the wider
// cone outside.
Sweep lampsInGlass(IntegratorKind integrator) {
    Sweep sweep{.kind = "glass", .name = "index, lamp in a block", .variant = nameOf(integrator)};
    sweep.parameter = "index - 1";
    sweep.values = {1e-6, 1e-4, 1e-2, 0.1, 0.33, 0.5, 1, 2, 3};
    sweep.against = "what the surface lets through, over the square of the index";
    sweep.measure = [=](double more, std::uint64_t seed) {
        test::SceneMaker maker;
        maker.box({-4, -4, -1}, {4, 4, 1},
                  maker.material(test::glass(static_cast<float>(1 + more))), false);
        maker.quad({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}, maker.diffuse({}, Rgb(1.0f)));
        maker.camera({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.01);
        return look(maker, {integrator, seed, 16, manyPasses(integrator)}).beauty;
    };
    sweep.expected = [](double more, std::uint64_t) {
        const auto n = static_cast<double>(static_cast<float>(1 + more));
        return (1 - fresnel(n, 1)) / (n * n);
    };
    return sweep;
}

// Half so many slabs as there are interfaces, between z = 1 and 2.
void addSlabs(test::SceneMaker& maker, double interfaces, double side) {
    const auto glass = maker.material(test::glass());
    const int slabs = static_cast<int>(std::lround(interfaces / 2));
    for (int i = 0; i < slabs; ++i) {
        const double z = 1 + static_cast<double>(i) / slabs;
        maker.box({-side, -side, z}, {side, side, z + 0.5 / slabs}, glass, false);
    }
}

Sweep chains(IntegratorKind integrator) {
    Sweep sweep{.kind = "glass", .name = "chain of slabs, seen through"};
    sweep.variant = nameOf(integrator);
    sweep.parameter = "interfaces";
    sweep.values = {2, 4, 10, 20, 50, 100};
    sweep.against = "what so many surfaces let through";
    sweep.isLong = integrator == IntegratorKind::kPhoton;
    sweep.measure = [=](double interfaces, std::uint64_t seed) {
        test::SceneMaker maker;
        maker.quad({-5, -5, 0}, {10, 0, 0}, {0, 10, 0}, maker.diffuse({}, Rgb(1.0f)));
        addSlabs(maker, interfaces, 4);
        maker.camera({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.1);
        return look(maker, {integrator, seed, 16, manyPasses(integrator) / 4}).beauty;
    };
    sweep.expected = [](double interfaces, std::uint64_t) {
        return throughSurfaces(interfaces, 0.04);
    };
    return sweep;
}

Sweep photonChains() {
    Sweep sweep{.kind = "glass", .name = "chain of slabs, by photons", .variant = "photon"};
    sweep.parameter = "interfaces";
    sweep.values = {2, 4, 10, 20, 50, 100};
    sweep.isLong = true;
    sweep.against = "the sun's light that so many surfaces let through";
    sweep.measure = [](double interfaces, std::uint64_t seed) {
        test::SceneMaker maker;
        maker.quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, maker.diffuse(Rgb(0.5f)));
        addSlabs(maker, interfaces, 2);
        maker.sun({0, 0, -1}, Rgb(static_cast<float>(2 * kPi)), 0);
        maker.camera({0, 0, 0.9}, {0, 0, 0}, {0, 1, 0}, 60);
        return look(maker, {.seed = seed}).caustic;
    };
    sweep.expected = [](double interfaces, std::uint64_t) {
        return throughSurfaces(interfaces, 0.04);
    };
    return sweep;
}

// Water in a hollow of a ball or block of glass: less wide than it by a gap, or wider.
Sweep waterInGlass(IntegratorKind integrator, bool isBox, bool overlaps) {
    Sweep sweep{.kind = "glass", .name = overlaps ? "water overlaps glass" : "water in glass, gap"};
    sweep.variant = nameOf(integrator) + (isBox ? ", block" : ", ball");
    constexpr double kCoincident = 1e-9;
    sweep.parameter = "gap or overlap, widths (1e-9: coincident)";
    sweep.values = decades(-1, -7);
    sweep.values.push_back(kCoincident);
    sweep.against = "invisible in a furnace: 1";
    sweep.flatFrom = 0.99e-6;
    if (isBox) sweep.flatAlso = kCoincident;
    sweep.limit = "two surfaces closer than rays can start between swallow light or make some";
    sweep.limit += isBox ? ", unless they coincide."
                         : "; round ones that coincide lose 1 to 2 % at the edges of triangles.";
    sweep.measure = [=](double value, std::uint64_t seed) {
        const double gap = value > kCoincident ? value : 0;
        test::SceneMaker maker;
        maker.box({-2, -2, -2}, {2, 2, 2}, maker.diffuse({}, Rgb(1.0f)), true);
        const auto add = [&](double half, float index) {
            const auto material = maker.material(test::glass(index));
            isBox ? maker.box(Vec3d(-half), Vec3d(half), material, false)
                  : maker.sphere({}, half, material);
        };
        add(1, 1.5f);
        add(0.5, 1 / 1.5f);
        add(0.5 + (overlaps ? gap : -gap), 1.33f);
        maker.camera({0.3, 0.4, 1.8}, {0, 0, 0}, {0, 1, 0}, 50);
        return look(maker, {integrator, seed}).beauty;
    };
    sweep.expected = [](double, std::uint64_t) { return 1.0; };
    return sweep;
}

}  // namespace

std::vector<Sweep> glassSweeps() {
    std::vector<Sweep> sweeps;
    for (const auto& make : {grazing, critical, indices, slabIndices, lampsInGlass, chains})
        for (const IntegratorKind integrator : kBoth) sweeps.push_back(make(integrator));
    sweeps.push_back(photonChains());
    for (const bool overlaps : {false, true})
        for (const bool isBox : {false, true})
            for (const IntegratorKind integrator : kBoth)
                sweeps.push_back(waterInGlass(integrator, isBox, overlaps));
    return sweeps;
}

}  // namespace pm::bench
