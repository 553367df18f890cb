// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "integrator/scene/scene.h"
#include "integrator/transport/frame_renderer.h"

namespace pm::test {

// Builds small scenes for tests, one call a line.
class SceneMaker {
  public:
    std::uint32_t diffuse(Rgb reflectance, Rgb emission = {});
    std::uint32_t material(const MaterialDescription& material);
    // Corners p, p+e0, p+e0+e1, p+e1; front towards cross(e0, e1).
    void quad(Vec3d p, Vec3d e0, Vec3d e1, std::uint32_t material, std::uint32_t divisions = 1);
    // All of one material, whatever the mesh has.
    void mesh(TriangleMesh mesh, std::uint32_t material);
    // A convex one, of three corners or more.
    void polygon(const std::vector<Vec3d>& corners, std::uint32_t material);
    // The six walls of an axis-aligned box, fronts inwards or outwards.
    void box(Vec3d lo, Vec3d hi, std::uint32_t material, bool inwards);
    void sphere(Vec3d centre, double radius, std::uint32_t material);
    // A tessellated sphere with smooth normals; rings x 2*rings quads.
    void meshSphere(Vec3d centre, double radius, std::uint32_t material, bool inwards, int rings);
    // Bends the shading normals of what was added last: one normal for all of it, object space.
    void bendNormals(Vec3d normal);
    void pointLight(Vec3d position, Rgb intensity);
    // angle: half of the cone's, falloff: of it; radians.
    void spot(Vec3d position, Vec3d direction, Rgb intensity, double angle, double falloff);
    void sun(Vec3d direction, Rgb irradiance, double angularRadius);
    void sky(Rgb radiance, std::shared_ptr<const TextureSource> picture = nullptr,
             const Transform& toWorld = kIdentityTransform);
    void camera(Vec3d eye, Vec3d lookAt, Vec3d up, double verticalDegrees);

    std::shared_ptr<const Scene> build() const;

    SceneDescription description;
};

// Mean over a picture's pixels, and how sure it is.
struct Measured {
    std::array<double, 3> mean{};
    std::array<double, 3> standardError{};  // of the mean, from the spread between passes
};

struct MeasuredLayers {
    Measured beauty, direct, indirect, caustic, emission;
    RenderCounters counters;
};

// Renders all passes on this machine's threads and averages each layer over `region` (empty: all).
MeasuredLayers measure(const std::shared_ptr<const Scene>& scene, RenderSettings settings,
                       Rect region = {});

// The same for several regions of `area` at once, each at the cost of none.
std::vector<MeasuredLayers> measureRegions(const std::shared_ptr<const Scene>& scene,
                                           const RenderSettings& settings, const Rect& area,
                                           const std::vector<Rect>& regions);

RenderSettings smallFrame(std::int32_t width, std::int32_t height, IntegratorKind integrator,
                          std::uint32_t passes, std::uint32_t aaLevel);

// Passes when |measured - expected| <= sigmas * standard error + relativeBias * expected, in every
// channel; prints both otherwise.
::testing::AssertionResult agrees(const Measured& measured, Rgb expected, double relativeBias,
                                  double sigmas = 4.0);
// The same between two measurements.
::testing::AssertionResult agree(const Measured& a, const Measured& b, double relativeBias,
                                 double sigmas = 4.0);

}  // namespace pm::test
