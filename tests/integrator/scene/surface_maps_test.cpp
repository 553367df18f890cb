// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What maps and tangents make of points of a scene: instances, mirrored ones, bump maps, and the
// light on a bumpy floor in closed form.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include "integrator/shapes/bump_map.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

constexpr Vec3f kUp{0, 1, 0};

void expectNear(const Vec3f& found, const Vec3f& right, float within = 1e-5f) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(found[axis], right[axis], within) << axis;
}

// A picture that is a function.
class Function : public TextureSource {
  public:
    explicit Function(std::function<Texel(Vec2f)> value, std::uint32_t texels = 64)
        : m_value(std::move(value)), m_texels(texels) {}
    Texel lookUp(std::int32_t, const TextureContext& at) const override {
        const Vec2f uv = at.uv;
        return m_value(uv);
    }
    std::array<std::uint32_t, 2> texels(std::int32_t) const override {
        return {m_texels, m_texels};
    }
    std::uint64_t failureCount() const override { return 0; }

  private:
    std::function<Texel(Vec2f)> m_value;
    std::uint32_t m_texels;
};

std::shared_ptr<const TextureSource> heights(std::function<float(Vec2f)> height) {
    return std::make_shared<Function>([height](Vec2f uv) {
        const float h = height(uv);
        return Texel{h, h, h, 1.0f};
    });
}

std::shared_ptr<const TextureSource> normals(const Vec3f& mapped) {
    const auto coded = [](float v) { return 0.5f * v + 0.5f; };
    const Texel texel{coded(mapped.x), coded(mapped.y), coded(mapped.z), 1.0f};
    return std::make_shared<Function>([texel](Vec2f) { return texel; });
}

// A floor of size 2 about the origin, u along x and v along -z, one of each a unit.
TriangleMesh floorMesh(float uPerUnit = 1.0f) {
    TriangleMesh mesh;
    mesh.positions = {{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}};
    for (const Vec3f& p : mesh.positions) mesh.texcoords.push_back({p.x * uPerUnit, -p.z});
    mesh.triangles = mesh.texcoordIndices = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

// What a ray meets straight from above, of a floor in a place of its own.
Surface metFromAbove(const MaterialDescription& material,
                     std::shared_ptr<const TextureSource> textures, const TriangleMesh& mesh,
                     const Transform& transform = kIdentityTransform) {
    SceneMaker maker;
    maker.mesh(mesh, maker.material(material));
    maker.description.instances.back().transform = transform;
    maker.description.textures = std::move(textures);
    maker.pointLight({0, 9, 0}, Rgb(1.0f));
    const auto scene = maker.build();
    Surface surface;
    const Vec3f centre(scene->centre());
    EXPECT_TRUE(scene->intersect({Vec3f{0.13f, 5, 0.21f} - centre, {0, -1, 0}}, surface));
    return surface;
}

MaterialDescription bumpy(float scale) {
    MaterialDescription material;
    material.diffuse = Rgb(0.5f);
    material.bumpTexture = 0;
    material.bumpScale = scale;
    return material;
}

MaterialDescription mapped() {
    MaterialDescription material;
    material.diffuse = Rgb(0.5f);
    material.normalTexture = 0;
    return material;
}

MaterialDescription brushed() {
    MaterialDescription material;
    material.kind = MaterialKind::kMirror;
    material.glossy = Rgb(0.9f);
    material.roughness = 0.3f;
    material.anisotropy = 0.8f;
    return material;
}

// What has no texture coordinates has no direction to be brushed along: told once a material, where
// it would have shown.
TEST(SurfaceMaps, LostAnisotropyIsToldOnceAMaterial) {
    const auto told = [](const MaterialDescription& material, const TriangleMesh& mesh) {
        SceneMaker maker;
        const auto index = maker.material(material);
        for (int i = 0; i < 3; ++i) maker.mesh(mesh, index);
        maker.pointLight({0, 9, 0}, Rgb(1.0f));
        const auto scene = maker.build();
        return std::ranges::count_if(scene->notices(), [](const Notice& notice) {
            return notice.text.find("anisotropic") != std::string::npos;
        });
    };
    TriangleMesh bare = floorMesh();
    bare.texcoords.clear();
    bare.texcoordIndices.clear();
    EXPECT_EQ(told(brushed(), bare), 1);
    EXPECT_EQ(told(brushed(), floorMesh()), 0);
    MaterialDescription dull = brushed();
    dull.kind = MaterialKind::kSurface;
    dull.glossy = Rgb(0.0f);
    EXPECT_EQ(told(dull, bare), 0);
}

TEST(SurfaceMaps, NormalMapsGoWithInstances) {
    const Vec3f map{0.6f, 0, 0.8f};
    expectNear(metFromAbove(mapped(), normals(map), floorMesh()).shadingNormal, {0.6f, 0.8f, 0});
    // A quarter turn about y: x to -z.
    const Transform turned{0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 0};
    expectNear(metFromAbove(mapped(), normals(map), floorMesh(), turned).shadingNormal,
               {0, 0.8f, -0.6f});
    // Stretched along u, tangents stay unit.
    const Transform stretched{3, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    expectNear(metFromAbove(mapped(), normals(map), floorMesh(), stretched).shadingNormal,
               {0.6f, 0.8f, 0});
}

// Seen in a mirror, red and green point where the mirror shows them.
TEST(SurfaceMaps, NormalMapsGoWithMirroredInstances) {
    const Transform mirrored{-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    // Its triangles' fronts are below; from above the mesh is met from behind.
    TriangleMesh mesh = floorMesh();
    for (auto* corners : {&mesh.triangles, &mesh.texcoordIndices})
        for (auto& triangle : *corners) std::swap(triangle[1], triangle[2]);
    const auto turnedBy = [&](const Vec3f& map) {
        return metFromAbove(mapped(), normals(map), mesh, mirrored).shadingNormal;
    };
    const Vec3f front = turnedBy({0, 0, 1});
    expectNear(turnedBy({0.6f, 0, 0.8f}), Vec3f{-0.6f, 0, 0} + front * 0.8f);
    expectNear(turnedBy({0, 0.6f, 0.8f}), Vec3f{0, 0, -0.6f} + front * 0.8f);
}

TEST(SurfaceMaps, AnisotropicMaterialsHaveATangent) {
    const Surface surface = metFromAbove(brushed(), nullptr, floorMesh());
    expectNear(surface.tangent, {1, 0, 0});
    EXPECT_FALSE(surface.isTextureMirrored);
    EXPECT_TRUE(metFromAbove(brushed(), nullptr, floorMesh(-1)).isTextureMirrored);
    TriangleMesh plain = floorMesh();
    plain.texcoords.clear();
    plain.texcoordIndices.clear();
    expectNear(metFromAbove(brushed(), nullptr, plain).tangent, {});
    // No other has one.
    expectNear(metFromAbove(mapped(), normals({0.6f, 0, 0.8f}), floorMesh()).tangent, {});
}

// At right angles to the normal that the map made.
TEST(SurfaceMaps, TangentsFollowTheMappedNormal) {
    MaterialDescription material = brushed();
    material.normalTexture = 0;
    const Surface surface = metFromAbove(material, normals({0.6f, 0, 0.8f}), floorMesh());
    expectNear(surface.shadingNormal, {0.6f, 0.8f, 0});
    expectNear(surface.tangent, {0.8f, -0.6f, 0});
}

TEST(BumpMap, FlatOnesChangeNothing) {
    const Vec3f bent = normalize(Vec3f{0.3f, 1, -0.2f});
    const TexturedEdges edges{{2, 0, 0}, {0, 0, -2}, {1, 0}, {0, 1}};
    EXPECT_EQ(bumpedNormal(bent, kUp, edges, {}), bent);
    const Surface flat = metFromAbove(bumpy(5), heights([](Vec2f) { return 0.37f; }), floorMesh());
    EXPECT_EQ(flat.shadingNormal, flat.geometricNormal);
}

// Heights that grow by a slope a unit of the scene: the normal of that slope.
TEST(BumpMap, IsTheNormalOfTheSlope) {
    const auto alongU = heights([](Vec2f uv) { return 0.5f * uv.x; });
    const auto alongV = heights([](Vec2f uv) { return 0.5f * uv.y; });
    const auto met = [&](const auto& picture, float scale, float uPerUnit = 1.0f,
                         const Transform& at = kIdentityTransform) {
        return metFromAbove(bumpy(scale), picture, floorMesh(uPerUnit), at).shadingNormal;
    };
    expectNear(met(alongU, 1), normalize(Vec3f{-0.5f, 1, 0}), 1e-4f);
    expectNear(met(alongV, 1), normalize(Vec3f{0, 1, 0.5f}), 1e-4f);
    expectNear(met(alongU, 4), normalize(Vec3f{-2, 1, 0}), 1e-4f);
    expectNear(met(alongU, -1), normalize(Vec3f{0.5f, 1, 0}), 1e-4f);
    // Repeated three times as often it is three times as steep; mirrored, it leans the other way.
    expectNear(met(alongU, 1, 3), normalize(Vec3f{-1.5f, 1, 0}), 1e-4f);
    expectNear(met(alongU, 1, -1), normalize(Vec3f{0.5f, 1, 0}), 1e-4f);
    // Heights are in scene units: on an instance of twice the size the slope is half.
    const Transform larger{2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0};
    expectNear(met(alongU, 1, 1, larger), normalize(Vec3f{-0.25f, 1, 0}), 1e-4f);
}

// On a shading normal that leans already the gradient lies in its plane.
TEST(BumpMap, TurnsBentNormals) {
    const Vec3f bent = normalize(Vec3f{0, 1, 1});
    const TexturedEdges edges{{2, 0, 0}, {0, 0, -2}, {2, 0}, {0, 2}};
    expectNear(bumpedNormal(bent, kUp, edges, {0.5, 0}), normalize(bent - Vec3f{0.5f, 0, 0}));
}

TEST(BumpMap, WithoutTextureAreaThereIsNone) {
    const TexturedEdges line{{2, 0, 0}, {0, 0, -2}, {1, 1}, {2, 2}};
    EXPECT_EQ(bumpedNormal(kUp, kUp, line, {1, 1}), kUp);
}

TEST(BumpMap, StaysAboveTheSurface) {
    const TexturedEdges edges{{2, 0, 0}, {0, 0, -2}, {2, 0}, {0, 2}};
    const Vec3f turned = bumpedNormal(kUp, kUp, edges, {1e12, 0});
    EXPECT_GT(dot(turned, kUp), 0.0f);
    EXPECT_NEAR(length(turned), 1.0f, 1e-6f);
}

// A floor below a parallel light that comes straight down, its heights a steady slope.
TEST(BumpMap, LightCountsByTheSlopesCosine) {
    for (const auto integrator : {IntegratorKind::kPath, IntegratorKind::kPhoton}) {
        SceneMaker maker;
        maker.mesh(floorMesh(), maker.material(bumpy(1)));
        maker.description.textures = heights([](Vec2f uv) { return 0.75f * uv.x; });
        maker.sun({0, -1, 0}, Rgb(2.0f), 0);
        maker.camera({0, 5, 0.01}, {0, 0, 0}, {0, 0, -1}, 15);
        const auto expected = static_cast<float>(0.5 / std::numbers::pi * 2 * 0.8);
        EXPECT_TRUE(agrees(measure(maker.build(), smallFrame(8, 8, integrator, 4, 2)).beauty,
                           Rgb(expected), 1e-3));
    }
}

// A closed room with a bumpy floor: photons and camera paths bring the same light.
TEST(BumpMap, PhotonsAndPathsAgree) {
    const auto room = [](IntegratorKind integrator) {
        SceneMaker maker;
        const std::uint32_t white = maker.diffuse(Rgb(0.6f));
        maker.mesh(floorMesh(), maker.material(bumpy(0.1f)));
        maker.quad({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}, white);
        maker.quad({-1, 0, 1}, {0, 0, -2}, {0, 2, 0}, white);
        maker.quad({1, 0, -1}, {0, 0, 2}, {0, 2, 0}, white);
        maker.quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, white);
        maker.quad({-0.4, 1.99, -0.4}, {0.8, 0, 0}, {0, 0, 0.8}, maker.diffuse(Rgb(), Rgb(4.0f)));
        maker.description.textures =
            heights([](Vec2f uv) { return 0.5f + 0.5f * std::sin(12.0f * uv.x); });
        maker.camera({0, 1, 3.5}, {0, 0.8, 0}, {0, 1, 0}, 40);
        return measure(maker.build(), smallFrame(24, 24, integrator, 8, 2)).beauty;
    };
    EXPECT_TRUE(agree(room(IntegratorKind::kPath), room(IntegratorKind::kPhoton), 0.01));
}

}  // namespace
}  // namespace pm::test
