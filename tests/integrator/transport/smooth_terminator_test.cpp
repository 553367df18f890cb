// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Coarse smooth meshes end in shadow where the surfaces that they stand for do.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/materials/bsdf.h"
#include "integrator/sampling/sampler.h"
#include "integrator/transport/path/direct_light.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

constexpr float kReflectance = 0.8f;

// What a ball of 4 x 8 quads reflects at the points that rays from all around meet.
class Ball {
  public:
    explicit Ball(SceneMaker maker) : m_scene(maker.build()), m_lights(*m_scene) {}

    struct Point {
        Surface surface;
        float found = 0.0f;
        bool isBeyond = false;  // its face turned away from the light
    };

    // towards(position): the unit direction to the light. Rays that meet something else: none.
    template <typename Towards, typename Visit>
    void forEachPoint(bool isSeen, const Towards& towards, const Visit& visit) const {
        constexpr std::uint32_t kRays = 4000;
        for (std::uint32_t i = 0; i < kRays; ++i) {
            const Sampler sampler(1, 0, i, 0);
            const Vec3f out = sampleUniformSphere(sampler.get2D(Purpose::kDirection));
            const Ray ray{Vec3f(-Vec3d(m_scene->centre())) + out * 1.5f, -out};
            Surface surface;
            if (!m_scene->intersect(ray, surface) || surface.shape != 0) continue;
            const Bsdf bsdf(m_scene->materials(), surface, out, Transport::kRadiance, Rgb(1.0f));
            std::uint32_t rays = 0;
            const DirectRadiance direct = estimateDirect(
                *m_scene, m_lights, surface, bsdf, DirectStrategy::kBoth, isSeen, 1, sampler, rays);
            visit(Point{surface, direct.of(Lobe::kDiffuse).g,
                        dot(surface.geometricNormal, towards(surface.position)) <= 0.0f});
        }
    }
    const Scene& scene() const { return *m_scene; }

  private:
    std::shared_ptr<const Scene> m_scene;
    LightSampler m_lights;
};

SceneMaker ballAlone() {
    SceneMaker maker;
    maker.meshSphere({0, 0, 0}, 1, maker.diffuse(Rgb(kReflectance)), false, 4);
    return maker;
}

TEST(SmoothTerminator, LightCountsByTheSmoothNormalAlone) {
    SceneMaker maker = ballAlone();
    const Vec3f towards = normalize(Vec3f{0.8f, 0.5f, 0.33f});
    maker.sun(Vec3d(-towards), Rgb(2.0f), 0);
    const Ball ball(maker);
    int beyond = 0;
    ball.forEachPoint(
        true, [&](const Vec3f&) { return towards; },
        [&](const Ball::Point& point) {
            const float cosine = std::max(0.0f, dot(point.surface.shadingNormal, towards));
            const float right = kReflectance / std::numbers::pi_v<float> * 2.0f * cosine;
            ASSERT_NEAR(point.found, right, 2e-5f)
                << "at " << point.surface.position.x << " " << point.surface.position.y << " "
                << point.surface.position.z << (point.isBeyond ? ", beyond its face" : "");
            if (point.isBeyond && cosine > 0.0f) ++beyond;
        });
    EXPECT_GT(beyond, 50);
}

// A light at a distance of its own: what shines beyond a face lies at the end of another ray.
TEST(SmoothTerminator, LampsNearbyDoAsWell) {
    SceneMaker maker = ballAlone();
    const Vec3f lamp{3, 1, 0.5f};
    maker.pointLight(Vec3d(lamp), Rgb(5.0f));
    const Ball ball(maker);
    const auto way = [&](const Vec3f& position) {
        return lamp - (position + Vec3f(ball.scene().centre()));
    };
    int beyond = 0;
    ball.forEachPoint(
        true, [&](const Vec3f& position) { return normalize(way(position)); },
        [&](const Ball::Point& point) {
            const Vec3f to = way(point.surface.position);
            const float cosine = std::max(0.0f, dot(point.surface.shadingNormal, normalize(to)));
            const float right =
                kReflectance / std::numbers::pi_v<float> * 5.0f * cosine / lengthSquared(to);
            ASSERT_NEAR(point.found, right, 1e-4f * right + 1e-6f);
            if (point.isBeyond && cosine > 0.0f) ++beyond;
        });
    EXPECT_GT(beyond, 50);
}

// Photons and paths that go on know the faces alone.
TEST(SmoothTerminator, OnlyWhatIsSeenIsSmooth) {
    SceneMaker maker = ballAlone();
    const Vec3f towards = normalize(Vec3f{0.8f, 0.5f, 0.33f});
    maker.sun(Vec3d(-towards), Rgb(2.0f), 0);
    const Ball ball(maker);
    ball.forEachPoint(
        false, [&](const Vec3f&) { return towards; },
        [&](const Ball::Point& point) {
            if (point.isBeyond) {
                ASSERT_EQ(point.found, 0.0f);
            }
        });
}

TEST(SmoothTerminator, ShadowsOfOthersStay) {
    SceneMaker maker = ballAlone();
    maker.quad({1.2, -3, -3}, {0, 6, 0}, {0, 0, 6}, maker.diffuse(Rgb(0.5f)));
    const Vec3f towards{1, 0, 0};
    maker.sun(Vec3d(-towards), Rgb(2.0f), 0);
    Ball(maker).forEachPoint(
        true, [&](const Vec3f&) { return towards; },
        [&](const Ball::Point& point) { ASSERT_EQ(point.found, 0.0f); });
}

// A hollow one seen from inside, where nothing is to be lifted.
TEST(SmoothTerminator, HollowSurfacesShadeThemselves) {
    SceneMaker maker;
    maker.meshSphere({0, 0, 0}, 1, maker.diffuse(Rgb(kReflectance)), true, 4);
    const auto scene = maker.build();
    for (std::uint32_t i = 0; i < 500; ++i) {
        const Sampler sampler(1, 0, i, 0);
        Surface surface;
        ASSERT_TRUE(scene->intersect(
            {Vec3f(0.0f), sampleUniformSphere(sampler.get2D(Purpose::kDirection))}, surface));
        SmoothPoint smooth;
        ASSERT_TRUE(scene->smoothPoint(surface, surface.geometricNormal, smooth));
        EXPECT_LT(length(smooth.position - Vec3d(surface.position)), 1e-6);
    }
}

// A coarse ball in a room, its lit half towards a wall: both integrators see the same of it.
TEST(SmoothTerminator, PhotonsAndPathsAgree) {
    const auto room = [](IntegratorKind integrator) {
        SceneMaker maker;
        const std::uint32_t white = maker.diffuse(Rgb(0.6f));
        maker.meshSphere({0, 0.7, 0}, 0.6, white, false, 4);
        maker.box({-1, 0, -1}, {1, 2, 1}, white, true);
        maker.quad({-0.99, 0.9, -0.3}, {0, 0.6, 0}, {0, 0, 0.6}, maker.diffuse(Rgb(), Rgb(6.0f)));
        maker.camera({0.1, 1, 0.95}, {0, 0.7, 0}, {0, 1, 0}, 70);
        return measureRegions(maker.build(), smallFrame(24, 24, integrator, 32, 2), {0, 0, 24, 24},
                              {{0, 0, 12, 12}, {12, 0, 24, 12}, {0, 12, 12, 24}, {12, 12, 24, 24}});
    };
    const auto path = room(IntegratorKind::kPath), photon = room(IntegratorKind::kPhoton);
    for (std::size_t i = 0; i < path.size(); ++i) {
        EXPECT_TRUE(agree(path[i].direct, photon[i].direct, 0.002)) << "region " << i;
        EXPECT_TRUE(agree(path[i].beauty, photon[i].beauty, 0.005)) << "region " << i;
    }
}

}  // namespace
}  // namespace pm::test
