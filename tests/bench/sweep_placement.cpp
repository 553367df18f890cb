// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Where a scene lies, how large it is, and from where it is seen.
#include <cmath>
#include <numbers>

#include "tests/bench/sweep.h"
#include "tests/bench/sweep_look.h"
#include "tests/integrator/rooms.h"

namespace pm::bench {

namespace {

// A closed room of width 2, with a lamp close under its ceiling, a ball of glass and one of grey.
test::SceneMaker closedRoom() {
    test::SceneMaker maker;
    const auto grey = maker.diffuse(Rgb(0.5f));
    maker.box({-1, -1, -1}, {1, 1, 1}, grey, true);
    maker.quad({-0.3, 0.99, -0.3}, {0.6, 0, 0}, {0, 0, 0.6}, maker.diffuse({}, Rgb(10.0f)));
    maker.sphere({0.4, -0.6, -0.3}, 0.25, maker.material(test::glass()));
    maker.meshSphere({-0.4, -0.7, -0.2}, 0.3, grey, false, 8);
    maker.camera({0, 0, 0.9}, {0, -0.1, 0}, {0, 1, 0}, 60);
    return maker;
}

Sweep moved(IntegratorKind integrator) {
    Sweep sweep{.kind = "placement", .name = "moved", .variant = nameOf(integrator)};
    sweep.parameter = "moved by, room widths / 2";
    sweep.values = decades(0, 8);
    sweep.against = "a closed room with a lamp and glass, at the origin";
    sweep.measure = [=](double by, std::uint64_t seed) {
        return look(placed(closedRoom(), 1, Vec3d{1, 0.7, -0.4} * by), {integrator, seed}).beauty;
    };
    sweep.wellAt = 0;
    return sweep;
}

Sweep scaled(IntegratorKind integrator) {
    Sweep sweep{.kind = "placement", .name = "scaled", .variant = nameOf(integrator)};
    sweep.parameter = "scale";
    sweep.values = decades(-6, 6);
    sweep.against = "the same room at scale 1";
    sweep.measure = [=](double by, std::uint64_t seed) {
        return look(placed(closedRoom(), by, {}), {integrator, seed}).beauty;
    };
    sweep.wellAt = 1;
    return sweep;
}

}  // namespace

std::vector<Sweep> placementSweeps() {
    std::vector<Sweep> sweeps;
    for (const IntegratorKind integrator : kBoth) {
        sweeps.push_back(moved(integrator));
        sweeps.push_back(scaled(integrator));
    }
    return sweeps;
}

}  // namespace pm::bench
