// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// How much gather rays differ, against a case whose distribution is known, and what follows from
// it.
#include "integrator/transport/survey/gather_pilot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "integrator/photons/map/photon_map.h"
#include "integrator/sampling/warps.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

constexpr double kReflectance = 0.5, kIrradiance = 100.0;
// Of the wall's foot from what the camera sees, and the wall's height and width.
constexpr double kDistance = 0.02, kWall = 8.0;
// All around the origin, as scenes are inside: photons lie where they are put.
constexpr double kFoot = -kWall / 2;

// The foot of an evenly lit wall in the open: half of the rays from there meet it, the others
// nothing.
struct WallFoot {
    std::shared_ptr<const Scene> scene;
    PhotonMap map;

    explicit WallFoot(double pointIntensity) : scene(make(pointIntensity)), map(photons()) {}

    static std::shared_ptr<const Scene> make(double pointIntensity) {
        SceneMaker maker;
        const std::uint32_t grey = maker.diffuse(Rgb(static_cast<float>(kReflectance)));
        const Vec3d corner{kFoot, kFoot, kFoot};
        maker.quad(corner, {kWall, 0, 0}, {0, kWall, 0}, grey);
        maker.quad(corner, {0, kWall, 0}, {0, 0, kWall}, grey);
        const double x = kFoot + kDistance;
        if (pointIntensity > 0)
            maker.pointLight({x, 0, kFoot + 1}, Rgb(static_cast<float>(pointIntensity)));
        maker.camera({x, 0, 0}, {x, 0, kFoot}, {0, 1, 0}, 0.02);
        return maker.build();
    }
    static std::vector<Photon> photons() {
        constexpr int kCells = 500;
        constexpr double kCell = kWall / kCells;
        const Rgb flux(static_cast<float>(kIrradiance * kCell * kCell));
        std::vector<Photon> photons;
        for (int j = 0; j < kCells; ++j)
            for (int i = 0; i < kCells; ++i)
                photons.push_back(
                    {Vec3f(Vec3d{kFoot, kFoot + (i + 0.5) * kCell, kFoot + (j + 0.5) * kCell}),
                     flux, PackedNormal({1, 0, 0})});
        return photons;
    }
    double spread(std::uint64_t seed) const {
        RenderSettings settings = smallFrame(48, 48, IntegratorKind::kPhoton, 1, 2);
        settings.seed = seed;
        const IrradianceSites sites(*scene, map, 0.1f);
        return gatherSpread(*scene, Camera(*scene, 48, 48), LightSampler(*scene), {sites}, settings,
                            {});
    }
};

// Mean of the spread over the number of 16 rays that meet the wall: binomial.
double expectedSpread(double direct) {
    constexpr int kRays = 16;
    const double met = (1 - kDistance / std::hypot(kDistance, kWall)) / 2;
    const double seen = kReflectance * kReflectance * kIrradiance / kPi;
    double sum = 0;
    for (int k = 0; k <= kRays; ++k) {
        const double probability =
            std::exp(std::lgamma(kRays + 1) - std::lgamma(k + 1) - std::lgamma(kRays - k + 1)) *
            std::pow(met, k) * std::pow(1 - met, kRays - k);
        const double mean = seen * k / kRays;
        const double variance = (k * seen * seen - kRays * mean * mean) / (kRays - 1);
        const double r = mean + direct;
        sum += probability * variance / (r * r + 0.01);
    }
    return sum;
}

struct Mean {
    double mean = 0, standardError = 0;
};

Mean meanSpread(const WallFoot& foot) {
    constexpr int kSeeds = 8;
    double sum = 0, squares = 0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        const double spread = foot.spread(static_cast<std::uint64_t>(seed));
        sum += spread;
        squares += spread * spread;
    }
    const double mean = sum / kSeeds;
    return {mean, std::sqrt((squares / kSeeds - mean * mean) / (kSeeds - 1))};
}

// The wall's sides end, which 0.1 % of the rays notice, and the estimate at a site is not exact: 2
// %.
TEST(GatherPilot, SpreadAtTheFootOfAWall) {
    const Mean found = meanSpread(WallFoot(0));
    EXPECT_NEAR(found.mean, expectedSpread(0), 4 * found.standardError + 0.02 * found.mean);
}

// Light that comes without gather rays makes their differences smaller beside it.
TEST(GatherPilot, DirectLightCountsInWhatIsSeen) {
    constexpr double kIntensity = 50;
    const Mean found = meanSpread(WallFoot(kIntensity));
    const double expected = expectedSpread(kReflectance * kIntensity / kPi);
    EXPECT_LT(expected, 0.4 * expectedSpread(0));
    EXPECT_NEAR(found.mean, expected, 4 * found.standardError + 0.02 * found.mean);
}

TEST(GatherPilot, NothingIsGatheredNothingDiffers) {
    SceneMaker maker;
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
    maker.camera({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 30);
    const auto scene = maker.build();
    const PhotonMap map(WallFoot::photons());
    const IrradianceSites sites(*scene, map, 0.1f);
    EXPECT_EQ(0.0, gatherSpread(*scene, Camera(*scene, 48, 48), LightSampler(*scene), {sites},
                                smallFrame(48, 48, IntegratorKind::kPhoton, 1, 2), {}));
}

// The rays go with the root of the spread, to the nearest power of two, within half and four times.
TEST(GatherPilot, RaysForASpread) {
    EXPECT_EQ(32u, gatherRaysFor(0.1, 32));
    EXPECT_EQ(32u, gatherRaysFor(0.19, 32));
    EXPECT_EQ(64u, gatherRaysFor(0.21, 32));
    EXPECT_EQ(64u, gatherRaysFor(0.79, 32));
    EXPECT_EQ(128u, gatherRaysFor(0.81, 32));
    EXPECT_EQ(128u, gatherRaysFor(1e9, 32));
    EXPECT_EQ(16u, gatherRaysFor(0.049, 32));
    EXPECT_EQ(16u, gatherRaysFor(0.0, 32));
    EXPECT_EQ(16u, gatherRaysFor(std::numeric_limits<double>::quiet_NaN(), 32));
    EXPECT_EQ(1u, gatherRaysFor(0.0, 1));
}

// A lamp in a corner, most of whose light is reflected by a small part of two walls; or one in the
// middle of the ceiling.
SceneMaker litRoom(bool inACorner) {
    SceneMaker maker;
    const double half = inACorner ? 0.02 : 0.25, at = inACorner ? -0.96 : 0;
    maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(0.8f)), true);
    maker.quad({at - half, 0.98, at - half}, {2 * half, 0, 0}, {0, 0, 2 * half},
               maker.diffuse(Rgb(0.0f), Rgb(inACorner ? 1000.0f : 10.0f)));
    maker.camera({0.9, 0, 0.9}, {0, -0.4, 0}, {0, 1, 0}, 70);
    return maker;
}

TEST(GatherPilot, ARenderObeysIt) {
    const auto countersOf = [](bool inACorner, std::uint32_t asked, PlanKind plan) {
        RenderSettings settings = smallFrame(32, 32, IntegratorKind::kPhoton, 1, 2);
        settings.gatherRays = asked;
        settings.plan = plan;
        return measure(litRoom(inACorner).build(), settings).counters;
    };
    const RenderCounters bright = countersOf(true, 0, PlanKind::kAuto);
    EXPECT_TRUE(bright.gatherRaysGuided);
    EXPECT_GE(bright.gatherRaysOfPoint, 64u);
    const RenderCounters even = countersOf(false, 0, PlanKind::kAuto);
    EXPECT_FALSE(even.gatherRaysGuided);
    EXPECT_LE(even.gatherRaysOfPoint, 64u);
    EXPECT_TRUE(countersOf(false, 0, PlanKind::kEverything).gatherRaysGuided);
    const RenderCounters asked = countersOf(true, 24, PlanKind::kAuto);
    EXPECT_FALSE(asked.gatherRaysGuided);
    EXPECT_EQ(24u, asked.gatherRaysOfPoint);
}

}  // namespace
}  // namespace pm::test
