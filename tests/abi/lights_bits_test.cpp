// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The same bits whatever the threads, buckets and crop, with every light that has no surface: a
// spot, a sun with a disc, a sky from a picture and a point light; over a floor with a grey, a
// glossy and a glass ball.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "tests/abi/host.h"

namespace pm::test {

namespace {

using Settings = std::map<std::string, std::string>;

// From the frame's pose: columns x, y, z, then the position.
struct Pose {
    double rows[12];
};

// Looks along -z down at the origin from (0, height, distance), tilted by the angle below.
Pose lookingDown(double height, double distance) {
    const double length = std::hypot(height, distance);
    const double s = height / length, c = distance / length;
    return {{1, 0, 0, 0, 0, c, s, height, 0, -s, c, distance}};
}

class LightsBits : public ::testing::TestWithParam<const char*> {
  protected:
    LightsBits() {
        EXPECT_EQ(PMR_OK, api().createScene(m_host.context(), nullptr, &m_scene));
        addFloor();
        addBall({-0.9, 0.5, 0}, PMR_MATERIAL_SURFACE, 0);
        addBall({0.3, 0.5, 0.6}, PMR_MATERIAL_DIELECTRIC, 0);
        addBall({1.3, 0.5, -0.4}, PMR_MATERIAL_SURFACE, 30);
        addLights();
        addSky();
        const Pose pose = lookingDown(2, 4);
        PmrCameraDesc camera = PMR_INIT(PmrCameraDesc);
        camera.transforms = pose.rows;
        camera.transformCount = 1;
        camera.fieldOfView = 0.9;
        EXPECT_EQ(PMR_OK, api().setCamera(m_scene, &camera));
        EXPECT_EQ(PMR_OK, api().commitScene(m_scene)) << m_host.lastError();
    }
    ~LightsBits() override { EXPECT_EQ(PMR_OK, api().releaseScene(m_scene)); }

    std::vector<float> render(Settings settings, PmrRectangle rectangle = {0, 0, kWide, kHigh}) {
        const Settings defaults = {{"integrator", GetParam()},
                                   {"passes", "2"},
                                   {"photons", "3000"},
                                   {"threads", "1"},
                                   {"width", std::to_string(kWide)},
                                   {"aaLevel", "2"},
                                   {"height", std::to_string(kHigh)},
                                   {"aaLevelMost", "3"},
                                   {"bucketSize", "8"}};
        settings.insert(defaults.begin(), defaults.end());
        PmrRender render = nullptr;
        EXPECT_EQ(PMR_OK, api().createRender(m_scene, nullptr, &render));
        for (const auto& [name, value] : settings)
            EXPECT_EQ(PMR_OK, api().setSettingText(render, name.c_str(), value.c_str()));
        EXPECT_EQ(PMR_OK, api().startRender(render)) << m_host.lastError();
        EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0)) << m_host.lastError();
        std::vector<float> pixels = readLayer(render, "beauty", 4, rectangle);
        EXPECT_EQ(PMR_OK, api().destroyRender(render));
        return pixels;
    }

    static constexpr std::int32_t kWide = 40, kHigh = 32;

  private:
    void addInstance(PmrMesh mesh, const PmrMaterialDesc& material) {
        PmrInstanceDesc instance = PMR_INIT(PmrInstanceDesc);
        PmrMaterial handle = nullptr;
        EXPECT_EQ(PMR_OK, api().createMaterial(m_host.context(), &material, &handle));
        instance.mesh = mesh;
        instance.materials = &handle;
        instance.materialCount = 1;
        EXPECT_EQ(PMR_OK, api().addInstance(m_scene, &instance)) << m_host.lastError();
        EXPECT_EQ(PMR_OK, api().releaseMesh(mesh));
        EXPECT_EQ(PMR_OK, api().releaseMaterial(handle));
    }
    void addFloor() {
        const float positions[12] = {-4, 0, 4, 4, 0, 4, 4, 0, -4, -4, 0, -4};
        const std::uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
        PmrMeshDesc mesh = PMR_INIT(PmrMeshDesc);
        mesh.positions = positions;
        mesh.positionCount = 4;
        mesh.indices = indices;
        mesh.indexCount = 6;
        mesh.faceCount = 2;
        PmrMaterialDesc material = PMR_INIT(PmrMaterialDesc);
        for (float& value : material.diffuse) value = 0.6f;
        PmrMesh handle = nullptr;
        EXPECT_EQ(PMR_OK, api().createMesh(m_host.context(), &mesh, &handle));
        addInstance(handle, material);
    }
    void addBall(const std::vector<double>& centre, std::int32_t kind, float exponent) {
        PmrSphereDesc sphere = PMR_INIT(PmrSphereDesc);
        std::memcpy(sphere.centre, centre.data(), sizeof sphere.centre);
        sphere.radius = 0.5;
        PmrMaterialDesc material = PMR_INIT(PmrMaterialDesc);
        material.kind = kind;
        for (float& value : material.diffuse) value = 0.5f;
        for (float& value : material.transmission) value = 1.0f;
        if (exponent > 0)
            for (float& value : material.glossy) value = 0.4f;
        material.glossyExponent = exponent;
        PmrMesh handle = nullptr;
        EXPECT_EQ(PMR_OK, api().createSphere(m_host.context(), &sphere, &handle));
        addInstance(handle, material);
    }
    void addLights() {
        const Pose above = lookingDown(3, 1), low = lookingDown(1, 1);
        for (const std::int32_t kind : {PMR_LIGHT_SPOT, PMR_LIGHT_DIRECTIONAL, PMR_LIGHT_POINT}) {
            PmrLightDesc light = PMR_INIT(PmrLightDesc);
            light.kind = kind;
            light.transforms = kind == PMR_LIGHT_DIRECTIONAL ? low.rows : above.rows;
            light.transformCount = 1;
            const float strength = kind == PMR_LIGHT_SPOT ? 20.0f : 1.0f;
            for (float& value : light.emission) value = strength;
            light.coneAngle = 0.3f;
            light.coneFalloff = 0.1f;
            light.angularRadius = 0.05f;
            EXPECT_EQ(PMR_OK, api().addLight(m_scene, &light)) << m_host.lastError();
        }
    }
    void addSky() {
        const std::string name = ::testing::TempDir() + "pm_bits_" + GetParam() + "." +
                                 std::to_string(getpid()) + ".ppm";
        std::FILE* file = std::fopen(name.c_str(), "wb");
        std::fputs("P6\n16 8\n255\n", file);
        for (int i = 0; i < 16 * 8 * 3; ++i) std::fputc(i * 37 % 256, file);
        std::fclose(file);
        PmrTextureDesc texture = PMR_INIT(PmrTextureDesc);
        texture.fileName = name.c_str();
        texture.wrapT = PMR_WRAP_CLAMP;
        PmrEnvironmentDesc sky = PMR_INIT(PmrEnvironmentDesc);
        for (float& value : sky.radiance) value = 0.5f;
        EXPECT_EQ(PMR_OK, api().createTexture(m_host.context(), &texture, &sky.texture));
        EXPECT_EQ(PMR_OK, api().setEnvironment(m_scene, &sky)) << m_host.lastError();
        EXPECT_EQ(PMR_OK, api().releaseTexture(sky.texture));
    }

    const BoxHost m_host;
    PmrScene m_scene = nullptr;
};

std::size_t unlikeFloats(const std::vector<float>& a, const std::vector<float>& b) {
    EXPECT_EQ(a.size(), b.size());
    std::size_t unlike = 0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        if (std::memcmp(&a[i], &b[i], sizeof(float)) != 0) ++unlike;
    return unlike;
}

TEST_P(LightsBits, AreTheSame) {
    const std::vector<float> first = render({});
    double sum = 0;
    for (const float value : first) {
        ASSERT_TRUE(std::isfinite(value));
        sum += static_cast<double>(value);
    }
    EXPECT_GT(sum / static_cast<double>(first.size()), 0.1);
    EXPECT_GT(unlikeFloats(first, render({{"seed", "2"}})), 0u);
    EXPECT_EQ(0u, unlikeFloats(first, render({{"threads", "3"}})));
    EXPECT_EQ(0u, unlikeFloats(first, render({{"bucketSize", "32"}})));
    EXPECT_EQ(0u, unlikeFloats(first, render({{"threads", "3"}, {"bucketSize", "32"}})));
    const PmrRectangle inside = {5, 3, 31, 22};
    EXPECT_EQ(0u, unlikeFloats(render({}, inside),
                               render({{"crop", "5,3,31,22"}, {"threads", "3"}}, inside)));
}

INSTANTIATE_TEST_SUITE_P(Integrators, LightsBits, ::testing::Values("photon", "path"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace

}  // namespace pm::test
