// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Rooms that brute force, both integrators and Cycles have in common.
#pragma once

#include <cmath>
#include <memory>

#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"

namespace pm::test {

// A room under a lamp as wide as its ceiling.
inline SceneMaker litRoom() {
    SceneMaker maker = openRoom();
    ceilingLamp(maker, 0.95, Rgb(2.0f));
    return maker;
}

inline SceneMaker withBalls(const MaterialDescription& left, const MaterialDescription& right) {
    SceneMaker maker = litRoom();
    maker.sphere({-0.45, -0.5, -0.2}, 0.4, maker.material(left));
    maker.sphere({0.45, -0.5, 0.1}, 0.4, maker.material(right));
    return maker;
}

inline MaterialDescription rough(MaterialDescription m, float roughness) {
    m.roughness = roughness;
    return m;
}

inline SceneMaker mirrorsOfOneMesh() {
    SceneMaker maker = litRoom();
    const auto mesh = std::make_shared<TriangleMesh>();
    mesh->positions = {{-0.3f, -0.3f, 0}, {0.3f, -0.3f, 0}, {0.3f, 0.3f, 0}, {-0.3f, 0.3f, 0}};
    mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
    const auto material = maker.material(rough(mirror(), 0.35f));
    for (const double angle : {0.4, 2.0, 4.5}) {
        InstanceDescription placed;
        placed.shape = std::shared_ptr<const TriangleMesh>(mesh);
        const double c = std::cos(angle), s = std::sin(angle);
        placed.transform = {c, 0, s, 0.5 * s, 0, 1, 0, -0.4, -s, 0, c, 0.5 * c};
        placed.materials = {material};
        maker.description.instances.push_back(placed);
    }
    return maker;
}

inline SceneMaker ballsUnderASky() {
    SceneMaker maker = withBalls(rough(glass(), 0.3f), rough(mirror(), 0.6f));
    maker.sky({0.5f, 0.7f, 1.0f});
    return maker;
}

}  // namespace pm::test
