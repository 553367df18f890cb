// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Materials that are mixed of others.
#include "tests/support/mixture.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "integrator/materials/bsdf.h"
#include "integrator/sampling/warps.h"
#include "integrator/values/error.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

constexpr IntegratorKind kIntegrators[] = {IntegratorKind::kPhoton, IntegratorKind::kPath};

MaterialDescription metal(float roughness, Rgb colour = Rgb(1.0f)) {
    MaterialDescription m = mirror();
    m.glossy = colour;
    m.roughness = roughness;
    return m;
}

MaterialDescription surface(Rgb diffuse, Rgb sheen = {}) {
    MaterialDescription m;
    m.diffuse = diffuse;
    m.sheen = sheen;
    return m;
}

// Two glossy of one role, one with sheen over a diffuse one, one more diffuse and one smooth.
std::uint32_t ofFive(SceneMaker& maker, Rgb colour) {
    const auto wide = maker.material(metal(0.36f, colour)),
               narrow = maker.material(metal(0.26f, colour));
    const auto cloth = maker.material(surface(colour, Rgb(0.5f)));
    const auto smooth = maker.material(metal(0, colour)), plain = maker.material(surface(colour));
    const auto shiny = maker.material(mixture(wide, narrow, 0.4f));
    const auto soft = maker.material(mixture(cloth, plain, 0.3f));
    return maker.material(mixture(maker.material(mixture(shiny, soft, 0.6f)), smooth, 0.2f));
}

TEST(Mixture, OfFiveLobesLosesNothing) {
    SceneMaker maker;
    maker.sphere({0, 0, 0}, 1, ofFive(maker, Rgb(1.0f)));
    maker.sky(Rgb(1.0f));
    maker.camera({0, 0, 6}, {0, 0, 0}, {0, 1, 0}, 14);
    for (const IntegratorKind integrator : kIntegrators) {
        RenderSettings settings = smallFrame(8, 8, integrator, 64, 3);
        settings.photons = 2000;
        // Fibres are white to some thousandths only.
        EXPECT_TRUE(agrees(measure(maker.build(), settings).beauty, Rgb(1.0f), 4e-3))
            << static_cast<int>(integrator);
    }
}

class Board {
  public:
    explicit Board(float scale = 1) {
        SceneMaker maker;
        m_surface.material = ofFive(maker, Rgb(0.8f * scale));
        m_surface.geometricNormal = m_surface.shadingNormal = {0, 0, 1};
        maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, m_surface.material);
        maker.camera({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 40);
        m_scene = maker.build();
    }
    Bsdf seenFrom(const Vec3f& out, Transport transport = Transport::kRadiance) const {
        return {m_scene->materials(), m_surface, out, transport, Rgb(1.0f)};
    }

  private:
    std::shared_ptr<const Scene> m_scene;
    Surface m_surface;
};

const Vec3f kOut = normalize(Vec3f{0.3f, 0.2f, 0.8f});
constexpr Lobe kRough[] = {Lobe::kDiffuse, Lobe::kWide, Lobe::kBroad};

TEST(Mixture, IsReciprocal) {
    const Board board;
    const Vec3f in = normalize(Vec3f{-0.5f, 0.1f, 0.6f});
    const Bsdf here = board.seenFrom(kOut), there = board.seenFrom(in);
    for (const Lobe lobe : kRough) {
        const float a = here.evaluate(lobe, in).g / in.z, b = there.evaluate(lobe, kOut).g / kOut.z;
        EXPECT_GT(a, 0.0f);
        EXPECT_NEAR(a, b, 3e-3f * a) << static_cast<int>(lobe);
    }
    // In photons it is the adjoint.
    const Bsdf photons = board.seenFrom(in, Transport::kPhotons);
    for (const Lobe lobe : kRough)
        EXPECT_NEAR(photons.evaluate(lobe, kOut).g / kOut.z, here.evaluate(lobe, in).g / in.z,
                    3e-3f * here.evaluate(lobe, in).g);
}

// The density integrates to the choice's probability, but for facets' directions below the surface,
// and samples weigh what is reflected.
TEST(Mixture, SamplesWhatItEvaluates) {
    const Bsdf bsdf = Board().seenFrom(kOut);
    constexpr int kSteps = 400;
    for (const Lobe lobe : kRough) {
        double density = 0, reflected = 0, sampled = 0;
        for (int i = 0; i < kSteps; ++i)
            for (int j = 0; j < kSteps; ++j) {
                const Vec2f u{(static_cast<float>(i) + 0.5f) / kSteps,
                              (static_cast<float>(j) + 0.5f) / kSteps};
                const Vec3f in = sampleUniformSphere(u);
                density += static_cast<double>(bsdf.pdfSolidAngle(lobe, in));
                reflected += static_cast<double>(bsdf.evaluate(lobe, in).g);
                BsdfSample sample;
                if (!bsdf.follow(
                        lobe, sample,
                        {u, (static_cast<float>((i * 31 + j * 17) % kSteps) + 0.5f) / kSteps}))
                    continue;
                sampled += static_cast<double>(sample.weight.g);
            }
        const double cell = 4 * 3.14159265358979 / (kSteps * kSteps);
        EXPECT_NEAR(density * cell, static_cast<double>(bsdf.probability(lobe)),
                    0.03 * density * cell)
            << static_cast<int>(lobe);
        EXPECT_NEAR(sampled / (kSteps * kSteps), reflected * cell, 0.01 * reflected * cell)
            << static_cast<int>(lobe);
    }
}

SceneMaker floorOf(const MaterialDescription* mixed, bool second) {
    SceneMaker maker = openRoom();
    ceilingLamp(maker, 0.5, Rgb(8.0f));
    const auto plain = maker.material(surface({0.7f, 0.5f, 0.3f})),
               gold = maker.material(metal(0.3f, {0.9f, 0.8f, 0.4f}));
    std::uint32_t material = second ? gold : plain;
    if (mixed) {
        MaterialDescription m = *mixed;
        m.first = plain;
        m.second = gold;
        material = maker.material(m);
    }
    maker.sphere({0, -0.4, 0}, 0.5, material);
    return maker;
}

TEST(Mixture, OfAllOrNothingIsThatPart) {
    for (const IntegratorKind integrator : kIntegrators)
        for (const bool second : {false, true}) {
            const MaterialDescription mixed = mixture(0, 0, second ? 1 : 0);
            RenderSettings settings = smallFrame(12, 12, integrator, 2, 2);
            settings.photons = 4000;
            const auto alone = measure(floorOf(nullptr, second).build(), settings).beauty.mean;
            EXPECT_EQ(measure(floorOf(&mixed, second).build(), settings).beauty.mean, alone);
        }
}

TEST(Mixture, WhatCannotBeMixedIsTold) {
    const auto textOf = [](const auto& change) {
        SceneMaker maker = openRoom();
        const auto plain = maker.material(surface(Rgb(0.5f)));
        const auto mixed = maker.material(mixture(plain, plain, 0.5f));
        maker.sphere({0, 0, 0}, 0.5, mixed);
        maker.description.materials[mixed].name = "mixed";
        change(maker, mixed);
        try {
            maker.build();
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(textOf([](SceneMaker&, std::uint32_t) {}), "");
    EXPECT_EQ(textOf([](SceneMaker& maker, std::uint32_t mixed) {
                  maker.description.materials[mixed].second = mixed;
              }),
              "mixture 'mixed' names itself");
    EXPECT_EQ(textOf([](SceneMaker& maker, std::uint32_t mixed) {
                  maker.description.materials[mixed].first = 99;
              }).substr(0, 36),
              "mixture 'mixed' names material 99 of");
    EXPECT_EQ(
        textOf([](SceneMaker& maker, std::uint32_t mixed) {
            const auto water = maker.material(glass(1.33f)), window = maker.material(glass());
            maker.description.materials[mixed].first = water;
            maker.description.materials[mixed].second = window;
        }),
        "mixture 'mixed' has parts of unlike glass: their index and thin walls have to be the "
        "same");
    EXPECT_EQ(textOf([](SceneMaker& maker, std::uint32_t mixed) {
                  std::uint32_t all = 1;
                  for (int i = 0; i < 6; ++i) all = maker.material(mixture(all, 1, 0.5f));
                  maker.description.materials[mixed].first = all;
              }).substr(0, 12),
              "mixture '' h");
}

}  // namespace
}  // namespace pm::test
