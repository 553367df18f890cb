// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "integrator/geometry/polygon_mesh.h"
#include "integrator/light_sampling/light_sampler.h"
#include "integrator/transport/survey/lit_places.h"
#include "tests/support/scene_maker.h"

namespace pm::test {

// Square lamps in a grid of rows x columns below a ceiling, facing down; all together they have
// the same area and radiance whatever their number.
inline void addLamps(SceneMaker& maker, std::uint32_t rows, std::uint32_t columns, double height) {
    constexpr double kArea = 0.2, kLow = -1.9, kWidth = 3.8;
    const double half = 0.5 * std::sqrt(kArea / (rows * columns));
    TriangleMesh mesh;
    for (std::uint32_t j = 0; j < rows; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) {
            const double x = kLow + kWidth * (i + 0.5) / columns;
            const double z = kLow + kWidth * (j + 0.5) / rows;
            const auto a = static_cast<std::uint32_t>(mesh.positions.size());
            mesh.positions.push_back(Vec3f(Vec3d{x - half, height, z - half}));
            mesh.positions.push_back(Vec3f(Vec3d{x + half, height, z - half}));
            mesh.positions.push_back(Vec3f(Vec3d{x + half, height, z + half}));
            mesh.positions.push_back(Vec3f(Vec3d{x - half, height, z + half}));
            mesh.triangles.push_back({a, a + 1, a + 2});
            mesh.triangles.push_back({a, a + 2, a + 3});
        }
    mesh.materials.assign(mesh.triangles.size(), 0);
    mesh.faces.resize(mesh.triangles.size());
    InstanceDescription instance;
    instance.shape = std::make_shared<const TriangleMesh>(std::move(mesh));
    instance.materials = {maker.diffuse({}, Rgb(48.0f))};
    maker.description.instances.push_back(std::move(instance));
}

// A room of 4 x 3 x 4 with two boxes, half of whose lamps are above a slab. The camera sees no
// lamp: of that many a pixel would hold many, and noise of its own.
inline SceneMaker makeRoom(std::uint32_t rows, std::uint32_t columns) {
    SceneMaker maker;
    const auto white = maker.diffuse(Rgb(0.6f)), red = maker.diffuse({0.6f, 0.2f, 0.2f});
    maker.quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, white);
    maker.quad({-2, 3, -2}, {4, 0, 0}, {0, 0, 4}, white);
    maker.quad({-2, 0, -2}, {4, 0, 0}, {0, 3, 0}, white);
    maker.quad({-2, 0, 2}, {0, 0, -4}, {0, 3, 0}, red);
    maker.quad({2, 0, -2}, {0, 0, 4}, {0, 3, 0}, red);
    maker.box({-1.2, 0, -1.2}, {-0.4, 1.2, -0.4}, white, false);
    maker.box({0.5, 0, -0.6}, {1.3, 0.7, 0.4}, white, false);
    addLamps(maker, rows, columns, 2.95);
    maker.box({-2, 2.5, -2}, {0, 2.6, 2}, white, false);
    maker.camera({0, 2.6, 5.5}, {0, 0.9, -0.5}, {0, 1, 0}, 26);
    return maker;
}

struct Room {
    std::shared_ptr<const Scene> scene;
    RenderSettings settings = smallFrame(96, 72, IntegratorKind::kPhoton, 4, 3);
    std::unique_ptr<LightSampler> lights;

    Room(std::uint32_t rows, std::uint32_t columns)
        : scene(makeRoom(rows, columns).build()), lights(std::make_unique<LightSampler>(*scene)) {}

    std::vector<LitPlace> places() const {
        return findLitPlaces(*scene, Camera(*scene, settings.width, settings.height), settings);
    }
    void learn() { lights->learn(places(), settings.seed); }
    // What a ray along -direction from a point, world, meets.
    Surface seen(Vec3d from, Vec3d direction) const {
        Surface surface;
        const Ray ray{Vec3f(from - scene->centre()), Vec3f(normalize(direction))};
        EXPECT_TRUE(scene->intersect(ray, surface));
        return surface;
    }
    // A floor, a wall, a box's top that half the lamps don't reach, and the top of the slab, where
    // no camera ray comes.
    std::vector<Surface> receivers() const {
        return {seen({1, 1, 1}, {0, -1, 0}), seen({0, 1, 0.5}, {-1, 0, 0.1}),
                seen({-0.8, 2, -0.8}, {0, -1, 0}), seen({-1, 2.8, 0}, {0, -1, 0}),
                seen({0, 1, 1.5}, {0, 0.2, -1})};
    }
};

inline Receiver facing(const Surface& surface) {
    return {surface.position, surface.shadingNormal};
}

}  // namespace pm::test
