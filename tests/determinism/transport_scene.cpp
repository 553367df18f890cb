// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/determinism/transport_scene.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <vector>

#include "tests/abi/host.h"

namespace pm::test {

namespace {

using Quad = std::array<float, 12>;  // four corners, counter-clockwise seen from the front
using Colour = std::array<float, 3>;

void setColour(float (&target)[3], const Colour& colour) {
    std::ranges::copy(colour, target);
}

// Makes materials and surfaces of a scene and lets go of the handles at once: the scene keeps what
// it uses.
class SceneMaker {
  public:
    explicit SceneMaker(PmrContext context) : m_context(context) {
        const PmrSceneDesc desc = PMR_INIT(PmrSceneDesc);
        EXPECT_EQ(PMR_OK, api().createScene(context, &desc, &m_scene));
    }

    PmrScene scene() const { return m_scene; }

    void addQuad(const Quad& corners, const PmrMaterialDesc& material) {
        constexpr std::uint32_t kIndices[] = {0, 1, 2, 3}, kFour = 4;
        constexpr float kUvs[] = {0, 0, 3, 0, 3, 3, 0, 3};
        PmrMeshDesc desc = PMR_INIT(PmrMeshDesc);
        desc.positions = corners.data();
        desc.positionCount = 4;
        desc.faceSizes = &kFour;
        desc.faceCount = 1;
        desc.indices = kIndices;
        desc.indexCount = 4;
        desc.uvs = kUvs;
        desc.uvCount = 4;
        PmrMesh mesh = nullptr;
        EXPECT_EQ(PMR_OK, api().createMesh(m_context, &desc, &mesh));
        add(mesh, material);
    }

    void addBall(const std::array<double, 3>& centre, double radius,
                 const PmrMaterialDesc& material) {
        PmrSphereDesc desc = PMR_INIT(PmrSphereDesc);
        std::ranges::copy(centre, desc.centre);
        desc.radius = radius;
        PmrMesh mesh = nullptr;
        EXPECT_EQ(PMR_OK, api().createSphere(m_context, &desc, &mesh));
        add(mesh, material);
    }

    void addPointLight(const std::array<double, 3>& place, const Colour& intensity) {
        const double transform[12] = {1, 0, 0, place[0], 0, 1, 0, place[1], 0, 0, 1, place[2]};
        PmrLightDesc desc = PMR_INIT(PmrLightDesc);
        desc.kind = PMR_LIGHT_POINT;
        desc.transforms = transform;
        desc.transformCount = 1;
        setColour(desc.emission, intensity);
        EXPECT_EQ(PMR_OK, api().addLight(m_scene, &desc));
    }

    void setCamera(double x, double y, double z) {
        const double transform[12] = {1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z};
        PmrCameraDesc desc = PMR_INIT(PmrCameraDesc);
        desc.transforms = transform;
        desc.transformCount = 1;
        desc.fieldOfView = 0.75;
        EXPECT_EQ(PMR_OK, api().setCamera(m_scene, &desc));
    }

  private:
    void add(PmrMesh mesh, const PmrMaterialDesc& desc) {
        PmrMaterial material = nullptr;
        EXPECT_EQ(PMR_OK, api().createMaterial(m_context, &desc, &material));
        PmrInstanceDesc instance = PMR_INIT(PmrInstanceDesc);
        instance.mesh = mesh;
        instance.materials = &material;
        instance.materialCount = 1;
        EXPECT_EQ(PMR_OK, api().addInstance(m_scene, &instance));
        EXPECT_EQ(PMR_OK, api().releaseMesh(mesh));
        EXPECT_EQ(PMR_OK, api().releaseMaterial(material));
    }

    PmrContext m_context;
    PmrScene m_scene = nullptr;
};

constexpr Quad kFloor = {-1, -1, 1, 1, -1, 1, 1, -1, -1, -1, -1, -1};
constexpr Quad kCeiling = {-1, 1, -1, 1, 1, -1, 1, 1, 1, -1, 1, 1};
constexpr Quad kBack = {-1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1};
constexpr Quad kLeft = {-1, -1, 1, -1, -1, -1, -1, 1, -1, -1, 1, 1};
constexpr Quad kRight = {1, -1, -1, 1, -1, 1, 1, 1, 1, 1, 1, -1};

PmrMaterialDesc diffuse(const Colour& colour) {
    PmrMaterialDesc desc = PMR_INIT(PmrMaterialDesc);
    setColour(desc.diffuse, colour);
    return desc;
}

PmrMaterialDesc glossy(const Colour& colour, const Colour& lobe, float exponent) {
    PmrMaterialDesc desc = diffuse(colour);
    setColour(desc.glossy, lobe);
    desc.glossyExponent = exponent;
    return desc;
}

PmrMaterialDesc mirror(const Colour& colour) {
    PmrMaterialDesc desc = PMR_INIT(PmrMaterialDesc);
    desc.kind = PMR_MATERIAL_MIRROR;
    setColour(desc.glossy, colour);
    return desc;
}

PmrMaterialDesc glass(const Colour& tint) {
    PmrMaterialDesc desc = PMR_INIT(PmrMaterialDesc);
    desc.kind = PMR_MATERIAL_DIELECTRIC;
    desc.ior = 1.5f;
    setColour(desc.transmission, tint);
    return desc;
}

PmrMaterialDesc lamp(const Colour& radiance) {
    PmrMaterialDesc desc = PMR_INIT(PmrMaterialDesc);
    setColour(desc.emission, radiance);
    return desc;
}

void addEveryTransport(PmrContext context, const std::string& texture, SceneMaker& maker) {
    PmrTextureDesc textureDesc = PMR_INIT(PmrTextureDesc);
    textureDesc.fileName = texture.c_str();
    PmrMaterialDesc checks = diffuse({0.9f, 0.9f, 0.9f});
    EXPECT_EQ(PMR_OK, api().createTexture(context, &textureDesc, &checks.diffuseTexture));
    maker.addQuad(kFloor, checks);
    EXPECT_EQ(PMR_OK, api().releaseTexture(checks.diffuseTexture));
    maker.addQuad(kCeiling, diffuse({0.7f, 0.7f, 0.7f}));
    maker.addQuad(kBack, glossy({0.2f, 0.25f, 0.3f}, {0.5f, 0.5f, 0.5f}, 60));
    maker.addQuad(kLeft, diffuse({0.6f, 0.1f, 0.08f}));
    maker.addQuad(kRight, mirror({0.9f, 0.9f, 0.9f}));
    PmrMaterialDesc veil = diffuse({0.3f, 0.6f, 0.3f});
    veil.transparency = 0.5f;
    maker.addQuad(
        {-0.9f, -0.2f, -0.5f, -0.3f, -0.2f, -0.5f, -0.3f, 0.5f, -0.5f, -0.9f, 0.5f, -0.5f}, veil);
    maker.addBall({-0.3, -0.6, 0.25}, 0.35, glass({0.9f, 1, 0.95f}));
    maker.addBall({0.45, -0.65, -0.3}, 0.35, mirror({0.8f, 0.7f, 0.5f}));
    maker.addBall({0.6, 0.4, -0.6}, 0.1, lamp({6, 4, 2}));
    maker.addQuad({-0.3f, 0.98f, -0.3f, 0.3f, 0.98f, -0.3f, 0.3f, 0.98f, 0.3f, -0.3f, 0.98f, 0.3f},
                  lamp({10, 9, 8}));
    maker.addPointLight({-0.6, 0.6, 0.6}, {0.2f, 0.3f, 0.5f});
}

void addSoftLight(SceneMaker& maker) {
    for (const Quad& wall : {kFloor, kBack, kLeft, kRight})
        maker.addQuad(wall, diffuse({0.6f, 0.5f, 0.4f}));
    maker.addQuad(kCeiling, lamp({1, 1, 1}));
    maker.addBall({0, -0.5, -0.25}, 0.5, diffuse({0.4f, 0.5f, 0.6f}));
}

}  // namespace

void writeFloorTexture(const std::string& file) {
    constexpr int kSide = 64;
    std::ofstream text(file);
    text << "P3\n" << kSide << ' ' << kSide << "\n255\n";
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x)
            text << ((x / 8 + y / 8) % 2 == 0 ? "230 184 115\n" : "77 61 38\n");
    }
}

PmrScene transportScene(PmrContext context, const SceneChoice& choice) {
    SceneMaker maker(context);
    if (choice.texture.empty())
        addSoftLight(maker);
    else
        addEveryTransport(context, choice.texture, maker);
    maker.setCamera(choice.cameraX, choice.cameraY, choice.cameraZ);
    EXPECT_EQ(PMR_OK, api().commitScene(maker.scene()));
    return maker.scene();
}

}  // namespace pm::test
