// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The camera that is framed from the bounds.
#include "host_shim/look/framing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/ingest/heard.h"

namespace pm::host::test {
namespace {

// Where a world point lies in the frame: x and y in [-1,1] inside.
std::array<double, 2> project(const CameraPose& pose, const std::array<double, 3>& point,
                              double aspect) {
    std::array<double, 3> local{};
    for (std::size_t column = 0; column < 3; ++column) {
        for (std::size_t row = 0; row < 3; ++row) {
            local[column] +=
                pose.transform[row * 4 + column] * (point[row] - pose.transform[row * 4 + 3]);
        }
    }
    EXPECT_LT(local[2], 0) << "behind the camera";
    const double tangent = std::tan(pose.verticalFov / 2);
    return {local[0] / -local[2] / tangent / aspect, local[1] / -local[2] / tangent};
}

TEST(Framing, allCornersAreInsideAndTheFrontFaceFits) {
    const Bounds bounds{{-1, 0, -3}, {2, 2, 1}};
    for (const double aspect : {0.5, 1.0, 4.0 / 3, 3.0}) {
        const CameraPose pose = frameCamera({}, bounds, aspect);
        double largest = 0;
        for (int corner = 0; corner < 8; ++corner) {
            const auto at = project(pose,
                                    {(corner & 1) != 0 ? bounds.high[0] : bounds.low[0],
                                     (corner & 2) != 0 ? bounds.high[1] : bounds.low[1],
                                     (corner & 4) != 0 ? bounds.high[2] : bounds.low[2]},
                                    aspect);
            largest = std::max({largest, std::abs(at[0]), std::abs(at[1])});
        }
        EXPECT_NEAR(largest, 1 / 1.05, 1e-9) << "aspect " << aspect;
    }
}

TEST(Framing, flatBoundsAndPointsStillHaveACamera) {
    const CameraPose pose = frameCamera({}, {{1, 1, 1}, {1, 1, 1}}, 1.0);
    EXPECT_GT(pose.eye[2], 1.0);
    for (const double value : pose.transform) EXPECT_TRUE(std::isfinite(value));
}

// A ground, or a wall along the view, would be a line from the front.
TEST(Framing, platesAreSeenFromTheSide) {
    for (const Bounds& bounds : {Bounds{{-1, 0, -1}, {2, 0, 1}}, Bounds{{5, -1, -1}, {5, 2, 1}},
                                 Bounds{{-1e4, 0, -1e4}, {1e4, 0.5, 1e4}}}) {
        for (const bool fromNegativeZ : {false, true}) {
            CameraOptions options;
            options.fromNegativeZ = fromNegativeZ;
            const CameraPose pose = frameCamera(options, bounds, 1.5);
            double least = 1, most = -1;
            for (int corner = 0; corner < 4; ++corner) {
                const double across = (corner & 1) != 0 ? 1 : 0;
                const bool lies = bounds.high[1] - bounds.low[1] < 1;
                std::array<double, 3> point = bounds.low;
                const std::size_t axis = lies ? 0 : 1;
                point[axis] += across * (bounds.high[axis] - bounds.low[axis]);
                if ((corner & 2) != 0) point[2] = bounds.high[2];
                const auto at = project(pose, point, 1.5);
                EXPECT_LT(std::max(std::abs(at[0]), std::abs(at[1])), 1);
                least = std::min(least, at[lies ? 1 : 0]);
                most = std::max(most, at[lies ? 1 : 0]);
            }
            EXPECT_GT(most - least, 0.3);
            EXPECT_EQ(pose.eye[2] < bounds.centre()[2], fromNegativeZ);
        }
    }
    EXPECT_EQ(frameCamera({}, {{-1, 0, 0}, {1, 0, 0}}, 1.0).eye[1], 0) << "a line stays one";
}

// One quad whose front faces along z: the default eye stands where the front is seen.
TEST(Framing, standsWhereFrontsAreSeen) {
    SceneData scene;
    MeshData quad;
    quad.positions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    quad.faceSizes = {4};
    quad.indices = {0, 1, 2, 3};
    scene.meshes = {quad};
    scene.placeEachMesh();
    EXPECT_FALSE(opensTowardsNegativeZ(scene));
    scene.meshes[0].indices = {0, 3, 2, 1};
    EXPECT_TRUE(opensTowardsNegativeZ(scene));
    CameraOptions options;
    options.fromNegativeZ = true;
    const CameraPose pose = frameCamera(options, {{0, 0, 0}, {1, 1, 0}}, 1.0);
    EXPECT_LT(pose.eye[2], 0);
    EXPECT_DOUBLE_EQ(pose.transform[10], -1) << "looks along +z";
    scene.meshes[0].indices = {0, 1, 2, 3, 0, 3, 2, 1};  // both sides: closed
    scene.meshes[0].faceSizes = {4, 4};
    EXPECT_FALSE(opensTowardsNegativeZ(scene));
}

TEST(Framing, optionsWin) {
    CameraOptions options;
    options.eye = {5, 0, 0};
    options.lookAt = {0, 0, 0};
    options.verticalFovDegrees = 90;
    const CameraPose pose = frameCamera(options, {{-1, -1, -1}, {1, 1, 1}}, 1.0);
    EXPECT_DOUBLE_EQ(pose.verticalFov, std::numbers::pi / 2);
    // Looks along -x, so its z axis is +x and its x axis -z.
    EXPECT_NEAR(pose.transform[2], 1, 1e-12);
    EXPECT_NEAR(pose.transform[8], -1, 1e-12);
    EXPECT_NEAR(pose.transform[5], 1, 1e-12);
}

TEST(Framing, upAlongTheViewIsReplaced) {
    CameraOptions options;
    options.eye = {0, 9, 0};
    options.lookAt = {0, 0, 0};
    const CameraPose pose = frameCamera(options, {{-1, -1, -1}, {1, 1, 1}}, 1.0);
    EXPECT_TRUE(pose.upWasReplaced);
    for (const double value : pose.transform) EXPECT_TRUE(std::isfinite(value));
    options.lookAt = options.eye;
    EXPECT_TRUE(errorOf([&] { frameCamera(options, {}, 1.0); }).starts_with("2 --eye and"));
}

}  // namespace
}  // namespace pm::host::test
