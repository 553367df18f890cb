// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Phase functions, and a vertex of a path where one scatters: closure, lamps that are sampled
// there.
#include <gtest/gtest.h>

#include <cmath>

#include "integrator/paths/vertex.h"
#include "integrator/transport/path/camera_step.h"
#include "integrator/transport/path/direct_light.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr std::uint32_t kCount = 40'000;
const Rgb kAlbedo{0.9f, 0.6f, 0.3f};

// Far from the quad, which is at the middle of the scene.
Vertex somewhere(const MediumScattering& medium) {
    Ray ray{{3, 1, 92}, normalize(Vec3f{-0.6f, 0.3f, -0.7f})};
    ray.time = 0.25f;
    return vertexInMedium(medium, ray, 2.0f);
}

// A sky, and a quad that hides less than a ten-thousandth of it.
SceneMaker skyAlone() {
    SceneMaker maker;
    maker.quad({-1, -1, -90}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
    maker.camera({0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 40);
    maker.sky(Rgb(0.7f));
    return maker;
}

// Of light from everywhere all is scattered that is not absorbed, and the mean cosine is g.
TEST(Phase, ScattersAllByItsMeanCosine) {
    const auto scene = skyAlone().build();
    for (const float g : {-0.8f, 0.0f, 5e-4f, 0.3f, 0.9f}) {
        const MediumScattering medium{{g}, kAlbedo};
        const Vertex vertex = somewhere(medium);
        EXPECT_EQ(vertex.surface.time, 0.25f);
        const Vec3f out = vertex.surface.geometricNormal;
        const Bsdf bsdf = vertex.closure(*scene, out, Transport::kRadiance, Rgb(1.0f));
        Random random(1);
        const Moments even = momentsOf(kCount, [&](std::uint32_t) {
            const Vec3f in = sampleUniformSphere(random.next2D());
            return static_cast<double>(4 * kPi * bsdf.evaluate(Lobe::kBroad, in).r);
        });
        const Moments cosine = momentsOf(kCount, [&](std::uint32_t) {
            BsdfSample sample;
            EXPECT_TRUE(bsdf.sample(random.next(), random.next2D(), sample));
            EXPECT_NEAR(sample.weight.g / kAlbedo.g, 1, 1e-5);
            const Rgb value = bsdf.evaluate(Lobe::kBroad, sample.direction);
            EXPECT_NEAR(value.b / kAlbedo.b / sample.pdfSolidAngle, 1, 1e-4);
            return static_cast<double>(-dot(out, sample.direction));
        });
        EXPECT_NEAR(even.mean, static_cast<double>(kAlbedo.r), 4 * even.standardError) << g;
        EXPECT_NEAR(cosine.mean, static_cast<double>(g), 4 * cosine.standardError) << g;
    }
}

TEST(Phase, IsReciprocal) {
    const MediumScattering medium{{0.6f}, kAlbedo};
    const auto scene = skyAlone().build();
    const Vec3f a = normalize(Vec3f{1, 2, 3}), b = normalize(Vec3f{-2, 1, 0.5f});
    const auto value = [&](const Vec3f& out, const Vec3f& in) {
        return somewhere(medium)
            .closure(*scene, out, Transport::kPhotons, Rgb(1.0f))
            .evaluate(Lobe::kBroad, in)
            .g;
    };
    EXPECT_FLOAT_EQ(value(a, b), value(b, a));
}

// Next-event estimation there looks to all sides: an even sky is seen as bright as the albedo.
TEST(Phase, LampsAreSampledOnAllSides) {
    const auto scene = skyAlone().build();
    const LightSampler lights(*scene);
    const MediumScattering medium{{0.5f}, kAlbedo};
    const Vertex vertex = somewhere(medium);
    const Vec3f out = vertex.surface.geometricNormal;
    const Bsdf bsdf = vertex.closure(*scene, out, Transport::kRadiance, Rgb(1.0f));
    std::uint32_t rays = 0;
    const Moments seen = momentsOf(kCount, [&](std::uint32_t i) {
        const Sampler sampler(1, 0, 0, i);
        Rgb light = estimateDirect(*scene, lights, vertex.surface, bsdf, DirectStrategy::kBoth,
                                   false, 1, sampler, rays)
                        .of(Lobe::kBroad);
        BsdfSample sample;
        EXPECT_TRUE(sampleLobe(bsdf, sampler, sample));
        light +=
            sample.weight * lightAlong(*scene, lights, rayFrom(vertex.surface, sample.direction),
                                       lastScatter(vertex.surface, sample), rays);
        return static_cast<double>(light.g);
    });
    EXPECT_NEAR(seen.mean, 0.7 * static_cast<double>(kAlbedo.g), 4 * seen.standardError + 1e-4);
}

}  // namespace
}  // namespace pm::test
