// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Scenes whose vertices are moved by what rounding may do.
#include <gtest/gtest.h>

#include <cmath>

#include "host_shim/formats/scene_twin.h"

namespace pm::host {
namespace {

SceneData scene() {
    SceneData data;
    data.meshes.resize(2);
    for (int i = 0; i < 100; ++i) {
        const auto t = static_cast<float>(i);
        for (const float value : {1 + t, std::sin(t) * 10, 0.0f})
            data.meshes[0].positions.push_back(value);
    }
    // The same places in another order.
    for (int i = 99; i >= 0; --i)
        for (std::size_t axis = 0; axis < 3; ++axis)
            data.meshes[1].positions.push_back(
                data.meshes[0].positions[3 * static_cast<std::size_t>(i) + axis]);
    data.spheres.push_back({"ball", {1, 2, 3}, 0.5});
    return data;
}

TEST(Twin, MovesByAtMostTheSeventhDigitAndEqualVerticesAlike) {
    const SceneData before = scene();
    SceneData twin = scene();
    makeTwin(1, twin);
    int moved = 0;
    for (std::size_t i = 0; i < 300; ++i) {
        const double was = before.meshes[0].positions[i], is = twin.meshes[0].positions[i];
        // Half a float's step more.
        EXPECT_LE(std::abs(is - was), (1e-7 + 6e-8) * std::abs(was)) << i;
        moved += is != was;
        EXPECT_EQ(twin.meshes[0].positions[i], twin.meshes[1].positions[3 * (99 - i / 3) + i % 3]);
    }
    EXPECT_GT(moved, 40);
    EXPECT_NE(twin.spheres[0].centre, before.spheres[0].centre);
    EXPECT_NE(twin.spheres[0].radius, before.spheres[0].radius);
    EXPECT_NEAR(twin.spheres[0].radius, 0.5, 0.5e-7);
}

TEST(Twin, IsTheSameAgainAndAnotherByNumber) {
    SceneData one = scene(), again = scene(), other = scene();
    makeTwin(1, one);
    makeTwin(1, again);
    makeTwin(2, other);
    EXPECT_EQ(one.meshes[0].positions, again.meshes[0].positions);
    EXPECT_NE(one.meshes[0].positions, other.meshes[0].positions);
}

}  // namespace
}  // namespace pm::host
