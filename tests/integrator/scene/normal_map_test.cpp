// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Normal maps: what a triangle's texture coordinates make of them, and the light on a mapped floor
// in closed form.
#include "integrator/shapes/normal_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

constexpr Vec3f kUp{0, 1, 0};

// u along x, v along -z: a floor seen from above.
TangentFrame floorFrame(bool isMirrored = false) {
    return tangentFrame({isMirrored ? -1.0f : 1.0f, 0, 0}, kUp, isMirrored);
}

void expectNear(const Vec3f& found, const Vec3f& right) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(found[axis], right[axis], 1e-6f) << axis;
}

TEST(NormalMap, EightBitsHaveAnExactMiddle) {
    EXPECT_EQ(decodedNormal(128.0f / 255.0f, 255), 0.0f);
    EXPECT_EQ(decodedNormal(1.0f, 255), 1.0f);
    EXPECT_EQ(decodedNormal(0.0f, 255), -1.0f);
    EXPECT_NEAR(decodedNormal(127.0f / 255.0f, 255), -1.0f / 127, 1e-6f);
}

TEST(NormalMap, SixteenBitsAndFloatsHaveOneToo) {
    EXPECT_EQ(decodedNormal(32768.0f / 65535.0f, 65535), 0.0f);
    EXPECT_EQ(decodedNormal(1.0f, 65535), 1.0f);
    EXPECT_EQ(decodedNormal(0.0f, 65535), -1.0f);
    EXPECT_EQ(decodedNormal(0.5f, 1), 0.0f);
    EXPECT_EQ(decodedNormal(1.0f, 1), 1.0f);
    EXPECT_EQ(decodedNormal(0.0f, 1), -1.0f);
    EXPECT_EQ(decodedNormal(0.75f, 1), 0.5f);
}

TEST(NormalMap, FlatOnesChangeNothing) {
    const Vec3f bent = normalize(Vec3f{0.3f, 1, -0.2f});
    const Vec3f kept = mappedNormal(bent, kUp, floorFrame(), {0, 0, 0.37f});
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(kept[axis], bent[axis]);
}

TEST(NormalMap, TurnsTowardsUAndV) {
    const float s = std::sqrt(0.5f);
    expectNear(mappedNormal(kUp, kUp, floorFrame(), {s, 0, s}), {s, s, 0});
    expectNear(mappedNormal(kUp, kUp, floorFrame(), {0, s, s}), {0, s, -s});
}

// Where u runs the other way, as on the second half of a symmetric model, so does red; green does
// not.
TEST(NormalMap, MirroredTexturesTurnAlong) {
    const float s = std::sqrt(0.5f);
    expectNear(mappedNormal(kUp, kUp, floorFrame(true), {s, 0, s}), {-s, s, 0});
    expectNear(mappedNormal(kUp, kUp, floorFrame(true), {0, s, s}), {0, s, -s});
}

// The frame counts as it was interpolated: a tangent that is short, or not at right angles to the
// normal, is taken so, as by what baked the map.
TEST(NormalMap, FramesAreNotPutRight) {
    const Vec3f tangent{0.6f, 0.3f, 0}, normal{0, 0.9f, 0};
    const TangentFrame frame = tangentFrame(tangent, normal, false);
    expectNear(mappedNormal(kUp, kUp, frame, {0.6f, 0.3f, 0.8f}),
               normalize(tangent * 0.6f + cross(normal, tangent) * 0.3f + normal * 0.8f));
}

TEST(NormalMap, WithoutATangentThereIsNone) {
    expectNear(mappedNormal(kUp, kUp, tangentFrame({}, kUp, false), {0.6f, 0, 0.8f}), kUp);
}

TEST(NormalMap, StaysAboveTheSurface) {
    const Vec3f turned = mappedNormal(kUp, kUp, floorFrame(), {1, 0, -1});
    EXPECT_GT(dot(turned, kUp), 0.0f);
    EXPECT_NEAR(length(turned), 1.0f, 1e-6f);
}

// One texel for all.
class OneTexel : public TextureSource {
  public:
    explicit OneTexel(const Texel& texel) : m_texel(texel) {}
    Texel lookUp(std::int32_t, const TextureContext&) const override { return m_texel; }
    std::array<std::uint32_t, 2> texels(std::int32_t) const override { return {1, 1}; }
    std::uint64_t failureCount() const override { return 0; }

  private:
    Texel m_texel;
};

// A floor below a parallel light that comes straight down, its normals turned by a map.
Measured floorUnder(const Vec3f& mapped, float scale, IntegratorKind integrator) {
    SceneMaker maker;
    MaterialDescription material;
    material.diffuse = Rgb(0.5f);
    material.normalTexture = 0;
    material.normalScale = scale;
    TriangleMesh mesh;
    mesh.positions = {{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}};
    mesh.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles = mesh.texcoordIndices = {{0, 1, 2}, {0, 2, 3}};
    maker.mesh(mesh, maker.material(material));
    const auto coded = [](float v) { return 0.5f * v + 0.5f; };
    maker.description.textures =
        std::make_shared<OneTexel>(Texel{coded(mapped.x), coded(mapped.y), coded(mapped.z), 1.0f});
    maker.sun({0, -1, 0}, Rgb(2.0f), 0);
    maker.camera({0, 5, 0.01}, {0, 0, 0}, {0, 0, -1}, 15);
    return measure(maker.build(), smallFrame(8, 8, integrator, 4, 2)).beauty;
}

TEST(NormalMap, LightCountsByTheMappedCosine) {
    for (const auto integrator : {IntegratorKind::kPath, IntegratorKind::kPhoton})
        for (const double degrees : {0.0, 30.0, 60.0}) {
            const double a = degrees * std::numbers::pi / 180;
            const Vec3f mapped{static_cast<float>(std::sin(a)), 0, static_cast<float>(std::cos(a))};
            const auto expected = static_cast<float>(0.5 / std::numbers::pi * 2 * std::cos(a));
            EXPECT_TRUE(agrees(floorUnder(mapped, 1, integrator), Rgb(expected), 1e-3)) << degrees;
        }
    // Scaled, the slope is: of 45 degrees half of it.
    const float s = std::sqrt(0.5f);
    const auto half = static_cast<float>(0.5 / std::numbers::pi * 2 / std::sqrt(1.25));
    EXPECT_TRUE(agrees(floorUnder({s, 0, s}, 0.5f, IntegratorKind::kPath), Rgb(half), 1e-3));
}

}  // namespace
}  // namespace pm::test
