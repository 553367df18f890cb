// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Geometry, materials and scenes with wrong values.
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <limits>
#include <vector>

#include "tests/abi/box_scene.h"
#include "tests/abi/host.h"

namespace pm::test {

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

class MisuseScene : public ::testing::Test {
  protected:
    MisuseScene() {
        m_mesh.positions = m_positions;
        m_mesh.positionCount = 4;
        m_mesh.faceCount = 2;
        m_mesh.indices = m_indices;
        m_mesh.indexCount = 6;
        EXPECT_EQ(PMR_OK, api().createScene(host.context(), nullptr, &m_scene));
    }
    ~MisuseScene() override { EXPECT_EQ(PMR_OK, api().releaseScene(m_scene)); }

    PmrStatus mesh() {
        PmrMesh made = nullptr;
        const PmrStatus status = api().createMesh(host.context(), &m_mesh, &made);
        if (made != nullptr) api().releaseMesh(made);
        return status;
    }
    PmrStatus cage(PmrCageDesc desc) {
        PmrMesh made = nullptr;
        const PmrStatus status = api().createCage(host.context(), &desc, &made);
        if (made != nullptr) api().releaseMesh(made);
        return status;
    }
    PmrStatus material(const PmrMaterialDesc& desc) {
        PmrMaterial made = nullptr;
        const PmrStatus status = api().createMaterial(host.context(), &desc, &made);
        if (made != nullptr) api().releaseMaterial(made);
        return status;
    }

    const BoxHost host;
    float m_positions[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    std::uint32_t m_indices[6] = {0, 1, 2, 0, 2, 3};
    PmrMeshDesc m_mesh = PMR_INIT(PmrMeshDesc);
    PmrScene m_scene = nullptr;
};

TEST_F(MisuseScene, Meshes) {
    EXPECT_EQ(PMR_OK, mesh());
    for (const float bad : {kNan, kInfinity, -kInfinity, 3e38f}) {
        m_positions[4] = bad;
        EXPECT_EQ(PMR_ERROR_SCENE, mesh());
    }
    m_positions[4] = 0;
    m_indices[5] = 4;
    EXPECT_EQ(PMR_ERROR_SCENE, mesh());
    m_indices[5] = PMR_NO_INDEX;
    EXPECT_EQ(PMR_ERROR_SCENE, mesh());
    m_indices[5] = 3;
    m_mesh.indexCount = 5;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, mesh());
    m_mesh.indexCount = 6;
    for (const std::uint64_t huge : {std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
        for (std::uint64_t* count : {&m_mesh.positionCount, &m_mesh.faceCount, &m_mesh.indexCount,
                                     &m_mesh.normalCount, &m_mesh.uvCount, &m_mesh.slotCount}) {
            const std::uint64_t right = *count;
            *count = huge;
            EXPECT_EQ(PMR_ERROR_ARGUMENT, mesh());
            *count = right;
        }
    }
    const std::uint32_t slots[2] = {0, 1}, sizes[2] = {3, 2}, uvIndices[6] = {0, 0, 9, 0, 0, 0};
    m_mesh.materialSlots = slots;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, mesh());
    m_mesh.slotCount = 2;
    EXPECT_EQ(PMR_OK, mesh());
    m_mesh.uvs = m_positions;
    m_mesh.uvCount = 2;
    m_mesh.uvIndices = uvIndices;
    EXPECT_EQ(PMR_ERROR_SCENE, mesh());
    EXPECT_NE(std::string::npos, host.lastError().find("uvIndices[2] is 9")) << host.lastError();
    m_mesh.uvCount = 0;
    m_mesh.faceSizes = sizes;
    EXPECT_EQ(PMR_ERROR_SCENE, mesh());
    m_mesh.positions = nullptr;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, mesh());
}

// What a host throws out of its message function is lost; the call is not.
TEST_F(MisuseScene, MessageThatThrows) {
    PmrContextDesc desc = PMR_INIT(PmrContextDesc);
    static int messages;
    messages = 0;
    desc.message = [](void*, PmrRender, std::int32_t, std::int32_t, const char*) {
        ++messages;
        throw 1;
    };
    PmrContext context = nullptr;
    ASSERT_EQ(PMR_OK, api().createContext(&desc, &context));
    const float flat[9] = {0, 0, 0, 1, 0, 0, 2, 0, 0};
    m_mesh.positions = flat;
    m_mesh.positionCount = 3;
    m_mesh.faceCount = 1;
    m_mesh.indexCount = 3;
    PmrMesh made = nullptr;
    EXPECT_EQ(PMR_OK, api().createMesh(context, &m_mesh, &made));
    EXPECT_EQ(1, messages);
    EXPECT_EQ(PMR_OK, api().releaseMesh(made));
    EXPECT_EQ(PMR_OK, api().releaseContext(context));
}

TEST_F(MisuseScene, Cages) {
    PmrCageDesc good = PMR_INIT(PmrCageDesc);
    good.mesh = &m_mesh;
    EXPECT_EQ(PMR_OK, cage(good)) << host.lastError();
    const std::uint32_t crease[2] = {0, 99}, hole = 12;
    const float sharpness[2] = {kNan, 1};
    PmrCageDesc bad = good;
    bad.mesh = nullptr;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, cage(bad));
    bad = good;
    bad.scheme = 7;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, cage(bad));
    bad = good;
    bad.boundary = -1;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, cage(bad));
    bad = good;
    bad.faceVarying = 6;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, cage(bad));
    bad = good;
    bad.tessellationRate = 65;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, cage(bad));
    bad = good;
    bad.creases = crease;
    bad.creaseSharpness = sharpness + 1;
    bad.creaseCount = 1;
    EXPECT_EQ(PMR_ERROR_SCENE, cage(bad));
    bad.creaseSharpness = nullptr;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, cage(bad));
    bad = good;
    bad.corners = crease;
    bad.cornerSharpness = sharpness;
    bad.cornerCount = 1;
    EXPECT_EQ(PMR_ERROR_SCENE, cage(bad));
    bad = good;
    bad.holes = &hole;
    bad.holeCount = 1;
    EXPECT_EQ(PMR_ERROR_SCENE, cage(bad));
    bad.holeCount = std::uint64_t{1} << 50;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, cage(bad));
}

// What lands on standard output and error while it lives, as libraries write it.
class Printed {
  public:
    Printed() {
        std::fflush(nullptr);
        for (const int stream : {1, 2}) {
            m_before[stream] = dup(stream);
            dup2(fileno(m_file), stream);
        }
    }
    ~Printed() { std::fclose(m_file); }
    std::string take() {
        std::fflush(nullptr);
        std::cout.flush();
        for (const int stream : {1, 2}) {
            dup2(m_before[stream], stream);
            close(m_before[stream]);
        }
        std::string text;
        std::rewind(m_file);
        for (int c = 0; (c = std::fgetc(m_file)) != EOF;) text += static_cast<char>(c);
        return text;
    }

  private:
    std::FILE* m_file = std::tmpfile();
    int m_before[3]{};
};

TEST_F(MisuseScene, DegenerateCages) {
    struct Case {
        std::uint64_t positions;
        std::vector<std::uint32_t> faceSizes, indices, holes;
        bool isAllowed;
    };
    // Without faces; all holes; faces of too few corners; all corners at one vertex; twice the
    // same.
    const std::vector<Case> cases = {{0, {}, {}, {}, false},
                                     {4, {}, {}, {}, false},
                                     {4, {4}, {0, 1, 2, 3}, {0}, true},
                                     {4, {0}, {}, {}, false},
                                     {4, {1}, {0}, {}, false},
                                     {4, {3, 2}, {0, 1, 2, 0, 1}, {}, false},
                                     {0, {3}, {0, 1, 2}, {}, false},
                                     {4, {3}, {0, 0, 0}, {}, true},
                                     {4, {4, 4}, {0, 1, 0, 2, 0, 1, 0, 2}, {}, true}};
    for (std::size_t i = 0; i < cases.size(); ++i)
        for (const int features : {0, 1}) {
            const Case& one = cases[i];
            m_mesh.positionCount = one.positions;
            m_mesh.faceCount = one.faceSizes.size();
            const std::uint32_t none = 0;
            m_mesh.faceSizes = one.faceSizes.empty() ? &none : one.faceSizes.data();
            m_mesh.indices = one.indices.data();
            m_mesh.indexCount = one.indices.size();
            PmrCageDesc desc = PMR_INIT(PmrCageDesc);
            desc.mesh = &m_mesh;
            desc.holes = one.holes.data();
            desc.holeCount = one.holes.size();
            const std::uint32_t crease[2] = {0, 1};
            const float sharpness = 2;
            desc.creases = desc.corners = crease;
            desc.creaseSharpness = desc.cornerSharpness = &sharpness;
            desc.creaseCount = desc.cornerCount = one.positions > 0 ? features : 0;
            Printed printed;
            const PmrStatus status = cage(desc);
            EXPECT_EQ("", printed.take()) << i;
            EXPECT_EQ(one.isAllowed ? PMR_OK : PMR_ERROR_SCENE, status) << i;
            if (!one.faceSizes.empty()) continue;
            EXPECT_EQ("the subdivision cage has no faces; it must have at least 1",
                      host.lastError());
        }
}

TEST_F(MisuseScene, Spheres) {
    for (const double radius : {0.0, -1.0, double{kNan}, double{kInfinity}}) {
        PmrSphereDesc desc = PMR_INIT(PmrSphereDesc);
        desc.radius = radius;
        PmrMesh made = nullptr;
        EXPECT_EQ(PMR_ERROR_ARGUMENT, api().createSphere(host.context(), &desc, &made));
    }
    PmrSphereDesc desc = PMR_INIT(PmrSphereDesc);
    desc.radius = 1;
    desc.centre[1] = kNan;
    PmrMesh made = nullptr;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().createSphere(host.context(), &desc, &made));
}

TEST_F(MisuseScene, Materials) {
    EXPECT_EQ(PMR_OK, material(PMR_INIT(PmrMaterialDesc)));
    const auto refused = [&](auto change) {
        PmrMaterialDesc desc = PMR_INIT(PmrMaterialDesc);
        desc.name = "mud";
        change(desc);
        EXPECT_EQ(PMR_ERROR_ARGUMENT, material(desc));
        EXPECT_NE(std::string::npos, host.lastError().find("mud")) << host.lastError();
    };
    for (const float bad : {kNan, kInfinity, -0.5f}) {
        refused([&](auto& desc) { desc.diffuse[1] = bad; });
        refused([&](auto& desc) { desc.glossy[2] = bad; });
        refused([&](auto& desc) { desc.glossyExponent = bad; });
        refused([&](auto& desc) { desc.ior = bad; });
        refused([&](auto& desc) { desc.transmission[0] = bad; });
        refused([&](auto& desc) { desc.emission[0] = bad; });
        refused([&](auto& desc) { desc.transparency = bad; });
    }
    refused([](auto& desc) { desc.diffuse[0] = 1.5f; });
    refused([](auto& desc) { desc.transparency = 1.5f; });
    refused([](auto& desc) { desc.kind = 4; });
    refused([](auto& desc) { desc.fresnel = 2; });
    PmrMaterialDesc desc = PMR_INIT(PmrMaterialDesc);
    desc.diffuseTexture = reinterpret_cast<PmrTexture>(host.scene());
    EXPECT_EQ(PMR_ERROR_HANDLE, material(desc));
}

TEST_F(MisuseScene, TextureFiles) {
    PmrTexture made = nullptr;
    PmrTextureDesc desc = PMR_INIT(PmrTextureDesc);
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().createTexture(host.context(), &desc, &made));
    for (const char* name : {"/nowhere/at/all.tx", "/", "/dev/null", "/etc/passwd"}) {
        desc.fileName = name;
        EXPECT_EQ(PMR_ERROR_IO, api().createTexture(host.context(), &desc, &made)) << name;
        EXPECT_NE(std::string::npos, host.lastError().find(name)) << host.lastError();
    }
    desc.wrapS = 9;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().createTexture(host.context(), &desc, &made));
    desc.wrapS = 0;
    desc.gain = kNan;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().createTexture(host.context(), &desc, &made));
}

TEST_F(MisuseScene, Instances) {
    PmrMesh made = nullptr;
    PmrMaterial surface = nullptr;
    const PmrMaterialDesc plain = PMR_INIT(PmrMaterialDesc);
    ASSERT_EQ(PMR_OK, api().createMesh(host.context(), &m_mesh, &made));
    ASSERT_EQ(PMR_OK, api().createMaterial(host.context(), &plain, &surface));
    PmrInstanceDesc good = PMR_INIT(PmrInstanceDesc);
    good.mesh = made;
    good.materials = &surface;
    good.materialCount = 1;
    double transforms[24] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const auto with = [&](auto change) {
        PmrInstanceDesc desc = good;
        change(desc);
        return api().addInstance(m_scene, &desc);
    };
    EXPECT_EQ(PMR_OK, api().addInstance(m_scene, &good));
    EXPECT_EQ(PMR_ERROR_HANDLE, with([](auto& desc) { desc.mesh = nullptr; }));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, with([](auto& desc) { desc.materials = nullptr; }));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, with([](auto& desc) { desc.materialCount = 0; }));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, with([](auto& desc) { desc.materialCount = ~0ull; }));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, with([](auto& desc) { desc.transformCount = 1; }));
    const auto withTransform = [&](std::uint64_t count) {
        return with([&](auto& desc) {
            desc.transforms = transforms;
            desc.transformCount = count;
        });
    };
    EXPECT_EQ(PMR_OK, withTransform(1));
    EXPECT_EQ(PMR_ERROR_UNSUPPORTED, withTransform(2));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, withTransform(0));
    for (const double bad : {double{kNan}, double{kInfinity}, 0.0}) {  // 0: singular
        transforms[5] = bad;
        EXPECT_EQ(PMR_ERROR_ARGUMENT, withTransform(1));
    }
    const BoxHost other;
    EXPECT_EQ(PMR_ERROR_STATE, api().addInstance(other.scene(), &good));
    PmrScene foreign = nullptr;
    ASSERT_EQ(PMR_OK, api().createScene(other.context(), nullptr, &foreign));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().addInstance(foreign, &good));
    EXPECT_EQ(PMR_OK, api().releaseScene(foreign));
    EXPECT_EQ(PMR_OK, api().releaseMesh(made));
    EXPECT_EQ(PMR_OK, api().releaseMaterial(surface));
    EXPECT_EQ(PMR_OK, api().commitScene(m_scene)) << host.lastError();  // they live in the scene
    EXPECT_EQ(PMR_ERROR_STATE, api().commitScene(m_scene));
}

TEST_F(MisuseScene, LightsEnvironmentsCameras) {
    PmrLightDesc light = PMR_INIT(PmrLightDesc);
    EXPECT_EQ(PMR_OK, api().addLight(m_scene, &light));
    light.emission[2] = kNan;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().addLight(m_scene, &light));
    for (const std::int32_t kind : {PMR_LIGHT_SPOT, PMR_LIGHT_DIRECTIONAL}) {
        light.kind = kind;  // more in lights_test.cpp
        EXPECT_EQ(PMR_ERROR_ARGUMENT, api().addLight(m_scene, &light));
    }
    light.kind = 77;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().addLight(m_scene, &light));
    PmrEnvironmentDesc sky = PMR_INIT(PmrEnvironmentDesc);
    EXPECT_EQ(PMR_OK, api().setEnvironment(m_scene, &sky));
    sky.radiance[0] = kNan;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setEnvironment(m_scene, &sky));
    PmrCameraDesc camera = PMR_INIT(PmrCameraDesc);
    for (const double angle : {0.0, -1.0, 3.2, double{kNan}, double{kInfinity}}) {
        camera.fieldOfView = angle;
        EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setCamera(m_scene, &camera));
    }
    camera.fieldOfView = 0.7;
    EXPECT_EQ(PMR_OK, api().setCamera(m_scene, &camera));
    camera.lensRadius = 0.1;
    EXPECT_EQ(PMR_ERROR_UNSUPPORTED, api().setCamera(m_scene, &camera));
    camera.lensRadius = kNan;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setCamera(m_scene, &camera));
    camera.lensRadius = 0;
    for (const std::int32_t kind : {PMR_CAMERA_ORTHOGRAPHIC, PMR_CAMERA_PANORAMA}) {
        camera.kind = kind;
        EXPECT_EQ(PMR_ERROR_UNSUPPORTED, api().setCamera(m_scene, &camera));
    }
    PmrSceneDesc scene = PMR_INIT(PmrSceneDesc);
    scene.rgbToXyz[0] = kNan;
    PmrScene made = nullptr;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().createScene(host.context(), &scene, &made));
    scene.rgbToXyz[0] = 1;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().createScene(host.context(), &scene, &made));
}

}  // namespace

}  // namespace pm::test
