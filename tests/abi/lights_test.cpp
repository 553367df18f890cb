// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Lights without area and environments through the interface: that they shine as the header says,
// and which values are refused.
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include "tests/abi/host.h"

namespace pm::test {

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kPi = std::numbers::pi_v<float>;

constexpr double kIdentity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

class Lights : public ::testing::Test {
  protected:
    Lights() { EXPECT_EQ(PMR_OK, api().createScene(m_host.context(), nullptr, &m_scene)); }
    ~Lights() override { EXPECT_EQ(PMR_OK, api().releaseScene(m_scene)); }

    // Renders the grey ball in the scene's lights, seen along -z from (0, 0, 5).
    void render() {
        addGreyBall(m_host.context(), m_scene);
        const double transform[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 5};
        PmrCameraDesc camera = PMR_INIT(PmrCameraDesc);
        camera.transforms = transform;
        camera.transformCount = 1;
        camera.fieldOfView = 1;
        ASSERT_EQ(PMR_OK, api().setCamera(m_scene, &camera));
        ASSERT_EQ(PMR_OK, api().commitScene(m_scene)) << m_host.lastError();
        PmrRender render = nullptr;
        ASSERT_EQ(PMR_OK, api().createRender(m_scene, nullptr, &render));
        api().setSettingInteger(render, "width", kSize);
        api().setSettingInteger(render, "height", kSize);
        api().setSettingInteger(render, "photons", 1000);
        ASSERT_EQ(PMR_OK, api().startRender(render)) << m_host.lastError();
        ASSERT_EQ(PMR_OK, api().waitRender(render, -1.0)) << m_host.lastError();
        m_beauty = readLayer(render, "beauty", 4, {0, 0, kSize, kSize});
        m_emission = readLayer(render, "emission", 3, {0, 0, kSize, kSize});
        EXPECT_EQ(PMR_OK, api().destroyRender(render));
    }
    float beauty(int x, int y, std::size_t channel) const {
        return m_beauty[4 * static_cast<std::size_t>(y * kSize + x) + channel];
    }
    float middle(std::size_t channel) const { return beauty(kSize / 2, kSize / 2, channel); }
    PmrStatus add(const PmrLightDesc& desc) { return api().addLight(m_scene, &desc); }

    static constexpr int kSize = 33;
    // Reflected by the ball for each unit of irradiance.
    static constexpr float kReflected = 0.5f / kPi;
    const BoxHost m_host;
    PmrScene m_scene = nullptr;
    std::vector<float> m_beauty, m_emission;
};

PmrLightDesc light(std::int32_t kind) {
    PmrLightDesc desc = PMR_INIT(PmrLightDesc);
    desc.kind = kind;
    for (float& value : desc.emission) value = 2.0f;
    desc.coneAngle = 0.5f;
    return desc;
}

TEST_F(Lights, ASpotShinesAlongMinusZ) {
    PmrLightDesc spot = light(PMR_LIGHT_SPOT);
    const double above[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 3};
    spot.transforms = above;
    spot.transformCount = 1;
    spot.coneAngle = 0.2f;
    spot.coneFalloff = 0.1f;
    ASSERT_EQ(PMR_OK, add(spot)) << m_host.lastError();
    render();
    EXPECT_NEAR(middle(0), kReflected * 2 / 4, 0.01f * kReflected);
    // The cone ends inside the ball's image.
    EXPECT_GT(beauty(kSize / 2 + 5, kSize / 2, 3), 0.9f);
    EXPECT_EQ(beauty(kSize / 2 + 5, kSize / 2, 0), 0);
}

TEST_F(Lights, ADirectionalLightTravelsAlongMinusZ) {
    ASSERT_EQ(PMR_OK, add(light(PMR_LIGHT_DIRECTIONAL))) << m_host.lastError();
    PmrLightDesc disc = light(PMR_LIGHT_DIRECTIONAL);
    disc.angularRadius = 0.02f;
    disc.emission[1] = 4.0f;
    // Towards +x, so behind the ball's left half only.
    const double turned[12] = {0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0};
    disc.transforms = turned;
    disc.transformCount = 1;
    ASSERT_EQ(PMR_OK, add(disc)) << m_host.lastError();
    render();
    EXPECT_NEAR(middle(0), kReflected * 2, 0.02f);
    EXPECT_GT(beauty(kSize / 2 - 6, kSize / 2, 1), 1.2f * beauty(kSize / 2 - 6, kSize / 2, 0));
    EXPECT_EQ(beauty(kSize / 2 + 6, kSize / 2, 1), beauty(kSize / 2 + 6, kSize / 2, 0));
}

// The environment is seen, in the emission layer, and has no coverage.
TEST_F(Lights, AnEnvironmentIsSeenWithoutCoverage) {
    PmrEnvironmentDesc sky = PMR_INIT(PmrEnvironmentDesc);
    ASSERT_EQ(PMR_OK, api().setEnvironment(m_scene, &sky));
    sky.radiance[0] = 1;
    sky.radiance[1] = 2;
    sky.radiance[2] = 3;
    ASSERT_EQ(PMR_OK, api().setEnvironment(m_scene, &sky))
        << m_host.lastError();  // the last counts
    render();
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const auto radiance = static_cast<float>(channel + 1);
        EXPECT_NEAR(beauty(0, 0, channel), radiance, 1e-5f);
        EXPECT_NEAR(m_emission[channel], radiance, 1e-5f);
        EXPECT_NEAR(middle(channel), 0.5f * radiance, 0.2f * radiance);
    }
    EXPECT_EQ(beauty(0, 0, 3), 0);
    EXPECT_EQ(middle(3), 1);
}

// Red, green over blue, white: middle towards -z, red on the left of what the camera sees.
TEST_F(Lights, ThePictureOfAnEnvironment) {
    const std::string name =
        ::testing::TempDir() + "pm_sky_texels." + std::to_string(getpid()) + ".ppm";
    const unsigned char texels[12] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
    FILE* file = std::fopen(name.c_str(), "wb");
    std::fputs("P6\n2 2\n255\n", file);
    std::fwrite(texels, 1, sizeof texels, file);
    std::fclose(file);
    PmrTextureDesc texture = PMR_INIT(PmrTextureDesc);
    texture.fileName = name.c_str();
    texture.wrapT = PMR_WRAP_CLAMP;
    PmrEnvironmentDesc sky = PMR_INIT(PmrEnvironmentDesc);
    for (float& value : sky.radiance) value = 1.0f;
    ASSERT_EQ(PMR_OK, api().createTexture(m_host.context(), &texture, &sky.texture));
    sky.transforms = kIdentity;
    sky.transformCount = 1;
    ASSERT_EQ(PMR_OK, api().setEnvironment(m_scene, &sky)) << m_host.lastError();
    EXPECT_EQ(PMR_OK, api().releaseTexture(sky.texture));  // it lives in the scene
    EXPECT_EQ(PMR_ERROR_HANDLE, api().setEnvironment(m_scene, &sky));
    render();
    const int last = kSize - 1;
    EXPECT_GT(beauty(0, 0, 0), 1.1f * beauty(0, 0, 1));
    EXPECT_GT(beauty(last, 0, 1), 1.1f * beauty(last, 0, 0));
    EXPECT_GT(beauty(0, last, 2), 1.5f * beauty(0, 0, 2));
    EXPECT_GT(beauty(last, last, 0), 1.1f * beauty(0, last, 1));
    EXPECT_EQ(beauty(0, 0, 3), 0);
}

// Each refusal has a line that names the member; what is at the edge of a range is taken.
TEST_F(Lights, WrongValuesAreRefused) {
    using Change = std::function<void(PmrLightDesc&)>;
    static constexpr double kStretched[12] = {1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0};
    static constexpr double kSheared[12] = {1, 0.5, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const auto transformed = [](const double* transform) {
        return [transform](PmrLightDesc& d) {
            d.transforms = transform;
            d.transformCount = 1;
        };
    };
    struct Case {
        std::int32_t kind;
        const char* named;
        Change change;
    };
    const auto bad = [&](const Case& c) {
        PmrLightDesc desc = light(c.kind);
        c.change(desc);
        EXPECT_EQ(PMR_ERROR_ARGUMENT, add(desc)) << c.named;
        EXPECT_NE(m_host.lastError().find(c.named), std::string::npos) << m_host.lastError();
    };
    for (const float angle : {0.0f, -0.1f, 3.2f, kNan})
        bad({PMR_LIGHT_SPOT, "coneAngle", [=](auto& d) { d.coneAngle = angle; }});
    for (const float falloff : {-0.1f, 0.51f, kNan})
        bad({PMR_LIGHT_SPOT, "coneFalloff", [=](auto& d) { d.coneFalloff = falloff; }});
    for (const float radius : {-0.1f, 1.6f, kNan})
        bad({PMR_LIGHT_DIRECTIONAL, "angularRadius", [=](auto& d) { d.angularRadius = radius; }});
    for (const std::int32_t kind : {PMR_LIGHT_SPOT, PMR_LIGHT_DIRECTIONAL}) {
        bad({kind, "rotation", transformed(kStretched)});
        bad({kind, "rotation", transformed(kSheared)});
        for (const float value : {-1.0f, kNan, std::numeric_limits<float>::infinity()})
            bad({kind, "emission", [=](auto& d) { d.emission[1] = value; }});
    }
    PmrLightDesc edge = light(PMR_LIGHT_SPOT);
    edge.coneAngle = edge.coneFalloff = kPi;
    EXPECT_EQ(PMR_OK, add(edge));
    edge = light(PMR_LIGHT_DIRECTIONAL);
    edge.angularRadius = kPi / 2;
    EXPECT_EQ(PMR_OK, add(edge));
    edge = light(PMR_LIGHT_POINT);
    transformed(kStretched)(edge);  // a point has no direction
    EXPECT_EQ(PMR_OK, add(edge));

    const auto badSky = [&](const char* named,
                            const std::function<void(PmrEnvironmentDesc&)>& change) {
        PmrEnvironmentDesc sky = PMR_INIT(PmrEnvironmentDesc);
        change(sky);
        EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setEnvironment(m_scene, &sky)) << named;
        EXPECT_NE(m_host.lastError().find(named), std::string::npos) << m_host.lastError();
    };
    badSky("radiance", [](auto& d) { d.radiance[2] = kNan; });
    badSky("radiance", [](auto& d) { d.radiance[0] = -1; });
    badSky("reserved", [](auto& d) { d.reserved = 1; });
    badSky("rotation", [](auto& d) {
        d.transforms = kSheared;
        d.transformCount = 1;
    });
    badSky("transformCount", [](auto& d) { d.transforms = kIdentity; });
}

}  // namespace

}  // namespace pm::test
