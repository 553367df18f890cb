// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Rooms inside of what absorbs, against closed forms: no way that light goes forgets what a medium
// takes on it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

constexpr IntegratorKind kIntegrators[] = {IntegratorKind::kPhoton, IntegratorKind::kPath};
// What is left of red, green and blue after a way of 1.
constexpr double kLeft[] = {0.5, 0.25, 1.0};

MaterialDescription absorbing(float ior, double thickness = 1) {
    MaterialDescription m;
    m.kind = MaterialKind::kDielectric;
    m.ior = ior;
    m.attenuationColour = {0.5f, 0.25f, 1.0f};
    m.attenuationDistance = static_cast<float>(1 / thickness);
    return m;
}

MaterialDescription halfThere(MaterialDescription m) {
    m.transparency = 0.5f;
    return m;
}

// value(left after a way of 1) in each channel.
template <typename Value>
Rgb byChannel(const Value& value) {
    return {static_cast<float>(value(kLeft[0])), static_cast<float>(value(kLeft[1])),
            static_cast<float>(value(kLeft[2]))};
}

// What the floor's middle gets of the lamp over it, by the midpoint rule; left(way): of that.
template <typename Left>
double irradianceUnderLamp(const Left& left) {
    constexpr int kSteps = 400;
    constexpr double kHalf = 1.0, kHeight = 0.4, kRadiance = 5, kCell = 2 * kHalf / kSteps;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
            const double x = -kHalf + (i + 0.5) * kCell, y = -kHalf + (j + 0.5) * kCell;
            const double squared = x * x + y * y + kHeight * kHeight;
            sum += kHeight * kHeight / (squared * squared) * left(std::sqrt(squared));
        }
    return kRadiance * sum * kCell * kCell;
}

// A floor under a wide lamp of radiance 5, .4 above it; seen from a place at this distance of the
// floor's middle, below the lamp.
constexpr double kEyeWay = 1.3;
SceneMaker underLamp() {
    SceneMaker maker;
    maker.quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, maker.diffuse(Rgb(0.5f)));
    maker.quad({-1, -1, 0.4}, {0, 2, 0}, {2, 0, 0}, maker.diffuse({}, Rgb(5.0f)));
    const double height = 0.2;
    maker.camera({0, -std::sqrt(kEyeWay * kEyeWay - height * height), height}, {0, 0, 0}, {0, 0, 1},
                 0.5);
    return maker;
}
void fill(SceneMaker& maker, const MaterialDescription& medium) {
    maker.box({-3, -3, -3}, {3, 3, 3}, maker.material(medium), false);
}

void expectDirect(const SceneMaker& maker, Rgb right, double bias, const std::string& what,
                  bool withoutCaustics = false) {
    for (const IntegratorKind integrator : kIntegrators) {
        RenderSettings settings = smallFrame(4, 4, integrator, 64, 3);
        settings.photons = 4000;
        const MeasuredLayers found = measure(maker.build(), settings);
        EXPECT_TRUE(agrees(found.direct, right, bias))
            << fmt::format("{}, integrator {}", what, static_cast<int>(integrator));
        if (withoutCaustics) {
            EXPECT_EQ(found.caustic.mean[2], 0.0) << what;
        }
    }
}

Rgb underLampIn(double thickness, double share = 1) {
    return byChannel([&](double one) {
        const double left = std::pow(one, thickness);
        return 0.5 / std::numbers::pi * share * std::pow(left, kEyeWay) *
               irradianceUnderLamp([&](double way) { return std::pow(left, way); });
    });
}

// A lamp that fills most of the floor's sky: rays along the lobe find it as well.
TEST(AbsorbingBody, NearALamp) {
    for (const float ior : {1.33f, 1.0f}) {
        SceneMaker maker = underLamp();
        fill(maker, absorbing(ior));
        expectDirect(maker, underLampIn(1), 2e-3, fmt::format("index {}", ior), ior == 1.0f);
    }
}

// The same where lamps are looked for beside what else a ray meets.
TEST(AbsorbingBody, NearALampWithWhatShadowsPass) {
    SceneMaker maker = underLamp();
    maker.quad({-2, -2, 0.3}, {4, 0, 0}, {0, 4, 0}, maker.diffuse({}));
    maker.description.instances.back().hiddenFrom = kShadowRays | kCameraRays;
    fill(maker, absorbing(1.33f));
    expectDirect(maker, underLampIn(1), 2e-3, "hidden sheet");
}

TEST(AbsorbingBody, CutOutsInside) {
    SceneMaker maker = underLamp();
    MaterialDescription sheet;
    sheet.transparency = 0.5f;
    maker.quad({-2, -2, 0.3}, {4, 0, 0}, {0, 4, 0}, maker.material(sheet));
    fill(maker, absorbing(1.33f));
    expectDirect(maker, underLampIn(1, 0.5), 2e-3, "sheet");
}

// The lamp is in the outer body, all else in the inner one, of the same index and three times as
// thick: their face bends nothing and is no caustic's.
TEST(AbsorbingBody, TwoOfOneIndexInOneAnother) {
    SceneMaker maker = underLamp();
    fill(maker, absorbing(1.33f));
    maker.box({-2.5, -2.5, -1}, {2.5, 2.5, 0.25}, maker.material(absorbing(1.33f, 3)), false);
    const Rgb right = byChannel([&](double one) {
        const auto left = [&](double way) {
            const double inner = way * 0.25 / 0.4;
            return std::pow(one, 3 * inner + way - inner);
        };
        return 0.5 / std::numbers::pi * std::pow(one, 3 * kEyeWay) * irradianceUnderLamp(left);
    });
    expectDirect(maker, right, 2e-3, "two bodies");
}

// The body's lower face is half there: what goes straight through it, with the factor of the index
// squared, has entered the body; the other half is bent and is none of direct light's.
TEST(AbsorbingBody, WhatGoesStraightThroughAFaceHasEntered) {
    SceneMaker maker;
    maker.quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, maker.diffuse(Rgb(0.5f)));
    maker.box({-4, -4, 1}, {4, 4, 2}, maker.material(halfThere(absorbing(1.33f))), false);
    maker.sun({0, 0, -1}, Rgb(2.0f), 0);
    maker.camera({0, -0.9, 0.5}, {0, 0, 0}, {0, 0, 1}, 1);
    const Rgb right = byChannel([](double one) { return 0.5 / std::numbers::pi * 2 * 0.25 * one; });
    for (const IntegratorKind integrator : kIntegrators) {
        RenderSettings settings = smallFrame(4, 4, integrator, 16, 2);
        settings.photons = 20000;
        EXPECT_TRUE(agrees(measure(maker.build(), settings).direct, right, 1e-4))
            << static_cast<int>(integrator);
    }
}

// A slab that bends nothing: the sun goes straight through it, by shadow rays.
TEST(AbsorbingBody, OfIndexOneIsMet) {
    SceneMaker maker;
    maker.quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, maker.diffuse(Rgb(0.5f)));
    maker.box({-4, -4, 1}, {4, 4, 1.5}, maker.material(absorbing(1.0f)), false);
    maker.sun({0, 0, -1}, Rgb(2.0f), 0);
    maker.camera({0, -0.9, 0.5}, {0, 0, 0}, {0, 0, 1}, 1);
    const Rgb right =
        byChannel([](double one) { return 0.5 / std::numbers::pi * 2 * std::sqrt(one); });
    expectDirect(maker, right, 1e-4, "slab", true);
}

// A room that is a sphere of radius 1 around a point light of intensity 1. With rho reflected and x
// the optical depth of its diameter, of what leaves the wall the share
// T = 2 (1 - (1 + x) exp(-x)) / x^2 comes back (the mean of exp(-x cos) over the cosine), and all
// of the wall has the same radiance.
double comesBack(double left) {
    const double x = -2 * std::log(left);
    return x < 1e-6 ? 1 : 2 * (1 - (1 + x) * std::exp(-x)) / (x * x);
}

TEST(AbsorbingBody, LightAllAround) {
    constexpr double kRho = 0.7;
    for (const float ior : {1.33f, 1.0f}) {
        SceneMaker maker;
        maker.sphere({0, 0, 0}, 1, maker.diffuse(Rgb(static_cast<float>(kRho))));
        fill(maker, absorbing(ior));
        maker.pointLight({0, 0, 0}, Rgb(1.0f));
        maker.camera({0.3, 0, 0}, {1, 0, 0}, {0, 0, 1}, 1);
        const auto direct = [&](double one) {
            return kRho / std::numbers::pi * one * std::pow(one, 0.7);
        };
        const Rgb rightDirect = byChannel(direct);
        const Rgb rightIndirect = byChannel([&](double one) {
            const double back = kRho * comesBack(one);
            return direct(one) * back / (1 - back);
        });
        for (const IntegratorKind integrator : kIntegrators) {
            RenderSettings settings = smallFrame(8, 8, integrator, 16, 3);
            settings.photons = 20000;
            const MeasuredLayers found = measure(maker.build(), settings);
            const auto where =
                fmt::format("index {}, integrator {}", ior, static_cast<int>(integrator));
            EXPECT_TRUE(agrees(found.direct, rightDirect, 1e-3)) << where;
            EXPECT_TRUE(agrees(found.indirect, rightIndirect, 0.01)) << where;
        }
    }
}

// Lamps that the camera sees, straight and in a mirror, inside the body.
TEST(AbsorbingBody, SeenLamps) {
    SceneMaker maker;
    maker.quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, maker.diffuse({}, Rgb(5.0f)));
    fill(maker, absorbing(1.33f));
    maker.camera({0, 0, 0}, {0, 2, 0}, {0, 0, 1}, 1);
    const Rgb right = byChannel([](double one) { return 5 * one * one; });
    for (const IntegratorKind integrator : kIntegrators)
        EXPECT_TRUE(agrees(measure(maker.build(), smallFrame(8, 8, integrator, 4, 2)).emission,
                           right, 1e-4))
            << static_cast<int>(integrator);
}

// Glass that is partly cut away, before an even sky: nothing absorbs, so all is as bright.
TEST(CutGlass, AnEvenSkyStaysEven) {
    for (const float ior : {1.5f, 2.4f}) {
        SceneMaker maker;
        MaterialDescription glass;
        glass.kind = MaterialKind::kDielectric;
        glass.ior = ior;
        maker.box({-1, -1, -1}, {1, 1, 1}, maker.material(halfThere(glass)), false);
        maker.sky(Rgb(1.0f));
        maker.camera({6, 4, 8}, {0, 0, 0}, {0, 1, 0}, 22);
        for (const IntegratorKind integrator : kIntegrators) {
            RenderSettings settings = smallFrame(16, 12, integrator, 32, 3);
            settings.photons = 1000;
            EXPECT_TRUE(agrees(measure(maker.build(), settings).beauty, Rgb(1.0f), 1e-4))
                << fmt::format("index {}, integrator {}", ior, static_cast<int>(integrator));
        }
    }
}

}  // namespace
}  // namespace pm::test
