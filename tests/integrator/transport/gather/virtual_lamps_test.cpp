// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Light that caustics send straight to other surfaces: what gather rays and rays to photons bring
// together is the integral over the lit patch, whether it is small and far or wide and near, and
// neither a speck nor noise comes of it.
#include "integrator/transport/gather/virtual_lamps.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <numbers>
#include <vector>

#include "integrator/sampling/warps.h"
#include "integrator/transport/gather/final_gather.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr double kReflectance = 0.6, kIrradiance = 2.0;
constexpr std::uint32_t kRays = 64;
constexpr std::uint32_t kReplicates = 400;

// A rectangle of the floor z = 0 that photons light evenly.
struct Patch {
    double x0, y0, x1, y1;
    int cells;  // to a side, one photon each

    // scale: of all lengths.
    std::vector<Photon> photons(float scale = 1) const {
        const double dx = (x1 - x0) / cells, dy = (y1 - y0) / cells;
        std::vector<Photon> photons;
        for (int j = 0; j < cells; ++j)
            for (int i = 0; i < cells; ++i)
                photons.push_back(
                    {Vec3f(Vec3d{x0 + (i + 0.5) * dx, y0 + (j + 0.5) * dy, -0.5}) * scale,
                     Rgb(static_cast<float>(kIrradiance * dx * dy)) * scale * scale,
                     PackedNormal({0, 0, 1})});
        return photons;
    }
    // Irradiance at a place from its reflected light, by the midpoint rule.
    double irradianceAt(const Vec3f& position, const Vec3f& normal) const {
        constexpr int kSteps = 2000;
        const double dx = (x1 - x0) / kSteps, dy = (y1 - y0) / kSteps;
        double sum = 0;
        for (int j = 0; j < kSteps; ++j)
            for (int i = 0; i < kSteps; ++i) {
                const Vec3d away =
                    Vec3d{x0 + (i + 0.5) * dx, y0 + (j + 0.5) * dy, -0.5} - Vec3d(position);
                const double squared = dot(away, away);
                const double up = dot(away, Vec3d(normal));
                if (up > 0) sum += up * -away.z / (squared * squared);
            }
        return sum * dx * dy * kIrradiance * kReflectance / std::numbers::pi;
    }
};

// A floor, a wall at x = -1 and a ceiling, around the origin: 2 x 2 x 1.
std::shared_ptr<const Scene> threeWalls(bool withScreen = false, double scale = 1,
                                        const MaterialDescription* filledWith = nullptr) {
    SceneMaker maker;
    if (filledWith)
        maker.box(Vec3d{-2, -2, -2} * scale, Vec3d{2, 2, 2} * scale, maker.material(*filledWith),
                  false);
    const auto grey = maker.diffuse(Rgb(static_cast<float>(kReflectance)));
    const auto quad = [&](Vec3d p, Vec3d e0, Vec3d e1) {
        maker.quad(p * scale, e0 * scale, e1 * scale, grey);
    };
    quad({-1, -1, -0.5}, {2, 0, 0}, {0, 2, 0});
    quad({-1, -1, -0.5}, {0, 2, 0}, {0, 0, 1});
    quad({-1, -1, 0.5}, {0, 2, 0}, {2, 0, 0});
    if (withScreen) quad({-1, -1, 0.1}, {2, 0, 0}, {0, 2, 0});
    maker.camera(Vec3d{3, 0, 0} * scale, {0, 0, 0}, {0, 0, 1}, 40);
    return maker.build();
}

// Of one number, over the mean.
double spreadOf(const Moments& moments) {
    return std::sqrt(moments.variance) / moments.mean;
}

// Irradiance at a place, by sets of rays. lamps: null: `sites`, which then hold the caustics,
// alone.
Moments gather(const Scene& scene, const IrradianceSites& sites, const VirtualLamps* lamps,
               const VirtualLamps::Place& place) {
    const Frame frame(place.shadingNormal);
    const GatherEnds ends{sites, lamps, kRays};
    return momentsOf(kReplicates, [&](std::uint64_t sequence) {
        double irradiance = 0;
        for (std::uint32_t i = 0; i < kRays; ++i) {
            Sampler sampler(7, 0, sequence, i);
            const Vec3f direction = normalize(
                frame.toWorld(sampleCosineHemisphere(sampler.get2D(Purpose::kDirection))));
            sampler.nextEvent();
            const float cosine = dot(direction, place.shadingNormal);
            irradiance += static_cast<double>(
                finalGather(scene, ends, {place.start, direction}, cosine, sampler)
                    .radiance.wide.g);
        }
        irradiance *= std::numbers::pi / kRays;
        if (lamps)
            irradiance += static_cast<double>(
                lamps->sampled(place, kRays, Sampler(8, 0, sequence, 0).get1D(Purpose::kCaustic))
                    .g);
        return irradiance;
    });
}

VirtualLamps::Place placeAt(const Vec3f& position, const Vec3f& normal) {
    return {position, position + normal * 1e-5f, normal, normal};
}

TEST(VirtualLamps, WithGatherRaysTheyBringAllThereIs) {
    const auto scene = threeWalls();
    const PhotonMap none(std::span<const Photon>{});
    const IrradianceSites empty(*scene, none, 0.1f);
    const auto ceiling = placeAt({0.3f, 0.2f, 0.5f}, {0, 0, -1});
    const auto wall = placeAt({-1, 0.1f, -0.2f}, {1, 0, 0});
    const auto foot = placeAt({-1, 0.1f, -0.47f}, {1, 0, 0});
    struct Case {
        const char* what;
        Patch patch;
        VirtualLamps::Place place;
        double bias;  // the blur of kept irradiance at the patch's edge
        double mostSpread;
        double leastGain;  // in spread, over gather rays alone
    };
    const Patch spot{-0.02, -0.02, 0.02, 0.02, 60}, pool{-0.7, -0.1, -0.4, 0.2, 100},
        floor{-1, -1, 1, 1, 200};
    for (const Case& c : {Case{"a spot, from the ceiling", spot, ceiling, 0.002, 0.01, 30},
                          Case{"a spot, from the wall", spot, wall, 0.002, 0.01, 30},
                          Case{"a pool, from the wall", pool, wall, 0.005, 0.07, 4},
                          Case{"a pool, from the wall's foot", pool, foot, 0.02, 0.15, 4},
                          Case{"the floor, from the wall", floor, wall, 0.01, 0.05, 0.8},
                          Case{"the floor, from the wall's foot", floor, foot, 0.02, 0.05, 0.8}}) {
        const PhotonMap caustics(c.patch.photons());
        const float radius = static_cast<float>(3 * (c.patch.x1 - c.patch.x0) / c.patch.cells);
        const VirtualLamps lamps(*scene, caustics, radius, nullptr, 1.0f, 5);
        const IrradianceSites sites(*scene, caustics, radius);
        const Moments found = gather(*scene, empty, &lamps, c.place);
        const Moments alone = gather(*scene, sites, nullptr, c.place);
        const double want = c.patch.irradianceAt(c.place.position, c.place.shadingNormal);
        fmt::print("    {}: {:.4f} of all +- {:.4f}, spread {:.4f}, of gather rays alone {:.4f}\n",
                   c.what, found.mean / want, found.standardError / want, spreadOf(found),
                   spreadOf(alone));
        EXPECT_NEAR(found.mean / want, 1, 4 * found.standardError / want + c.bias) << c.what;
        EXPECT_LT(spreadOf(found), c.mostSpread) << c.what;
        EXPECT_GT(spreadOf(alone), c.leastGain * spreadOf(found)) << c.what;
    }
}

TEST(VirtualLamps, AreHiddenByWhatIsBetween) {
    const auto scene = threeWalls(true);
    const PhotonMap none(std::span<const Photon>{});
    const IrradianceSites empty(*scene, none, 0.1f);
    const PhotonMap caustics(Patch{-0.2, -0.2, 0.2, 0.2, 50}.photons());
    const VirtualLamps lamps(*scene, caustics, 0.02f, nullptr, 1.0f, 5);
    EXPECT_EQ(gather(*scene, empty, &lamps, placeAt({0, 0, 0.5f}, {0, 0, -1})).mean, 0);
    EXPECT_GT(gather(*scene, empty, &lamps, placeAt({-1, 0, -0.2f}, {1, 0, 0})).mean, 0);
}

TEST(VirtualLamps, LoseWhatIsAbsorbedOnTheWay) {
    MaterialDescription medium;
    medium.kind = MaterialKind::kDielectric;
    medium.attenuationColour = {0.5f, 0.25f, 1.0f};
    medium.attenuationDistance = 1.0f;
    const PhotonMap caustics(Patch{-0.02, -0.02, 0.02, 0.02, 60}.photons());
    const auto fromCeiling = [&](const Scene& scene) {
        const VirtualLamps lamps(scene, caustics, 0.002f, nullptr, 1.0f, 5);
        return lamps.sampled(placeAt({0, 0, 0.5f}, {0, 0, -1}), kRays, 0.5f);
    };
    const Rgb clear = fromCeiling(*threeWalls()),
              left = fromCeiling(*threeWalls(false, 1, &medium));
    // A way of 1, and of up to 4e-4 more.
    EXPECT_NEAR(left.r / clear.r, 0.5f, 5e-4f);
    EXPECT_NEAR(left.g / clear.g, 0.25f, 5e-4f);
    EXPECT_NEAR(left.b / clear.b, 1.0f, 1e-5f);
}

// Of a sheet that is lit from below nothing shines up.
TEST(VirtualLamps, ShineOnTheirSideAlone) {
    const auto scene = threeWalls(true);
    std::vector<Photon> photons;
    for (int i = 0; i < 2500; ++i)
        photons.push_back({Vec3f(Vec3d{-0.2 + 0.008 * (i % 50), -0.2 + 0.008 * (i / 50), 0.1}),
                           Rgb(1e-4f), PackedNormal({0, 0, -1})});
    const PhotonMap caustics(photons);
    const VirtualLamps lamps(*scene, caustics, 0.03f, nullptr, 1.0f, 5);
    EXPECT_EQ(lamps.sampled(placeAt({0, 0, 0.5f}, {0, 0, -1}), kRays, 0.5f), Rgb());
    EXPECT_GT(lamps.sampled(placeAt({0, 0, -0.5f}, {0, 0, 1}), kRays, 0.5f).g, 0.0f);
}

// What goes through glass is refocused light's, by gather rays, too.
TEST(VirtualLamps, AreNotSeenThroughGlass) {
    SceneMaker maker;
    const auto grey = maker.diffuse(Rgb(static_cast<float>(kReflectance)));
    const MaterialDescription clear = glass(1.00001f);
    maker.quad({-1, -1, -0.5}, {2, 0, 0}, {0, 2, 0}, grey);
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(clear));
    maker.quad({-1, -1, 0.5}, {0, 2, 0}, {2, 0, 0}, grey);
    maker.camera({3, 0, 0}, {0, 0, 0}, {0, 0, 1}, 40);
    const auto scene = maker.build();
    const PhotonMap none(std::span<const Photon>{});
    const IrradianceSites empty(*scene, none, 0.1f);
    const PhotonMap caustics(Patch{-1, -1, 1, 1, 100}.photons());
    const VirtualLamps lamps(*scene, caustics, 0.06f, nullptr, 1.0f, 5);
    EXPECT_EQ(gather(*scene, empty, &lamps, placeAt({0, 0, 0.5f}, {0, 0, -1})).mean, 0);
}

// Irradiance knows no unit of length. But irradiance is kept in other cells, so weights differ.
TEST(VirtualLamps, InScenesOfAnySize) {
    const Patch pool{-0.7, -0.1, -0.4, 0.2, 50};
    const auto found = [&](float scale) {
        const auto scene = threeWalls(false, static_cast<double>(scale));
        const PhotonMap caustics(pool.photons(scale));
        const VirtualLamps lamps(*scene, caustics, 0.02f * scale, nullptr, 1.0f, 5);
        const Vec3f at{-1, 0.1f, -0.2f}, normal{1, 0, 0};
        return lamps.sampled({at * scale, (at + normal * 1e-5f) * scale, normal, normal}, kRays,
                             0.5f);
    };
    const float one = found(1).g;
    EXPECT_GT(one, 0.0f);
    for (const float scale : {1e-8f, 1e12f}) EXPECT_NEAR(found(scale).g / one, 1, 0.03) << scale;
}

TEST(VirtualLamps, NoCausticsNoLight) {
    const auto scene = threeWalls();
    const PhotonMap none(std::span<const Photon>{});
    const VirtualLamps lamps(*scene, none, 0.1f, nullptr, 1.0f, 5);
    const auto place = placeAt({0, 0, 0.5f}, {0, 0, -1});
    EXPECT_EQ(lamps.sampled(place, kRays, 0.5f), Rgb());
    EXPECT_EQ(lamps.gathered({0, 0, -0.5f}, {0, 0, 1}, 1.0f, kRays).wide, Rgb());
}

TEST(VirtualLamps, MakingThemCanBeCancelled) {
    const auto scene = threeWalls();
    const PhotonMap caustics(Patch{-0.2, -0.2, 0.2, 0.2, 50}.photons());
    const std::atomic<bool> cancelled{true};
    EXPECT_THROW(VirtualLamps(*scene, caustics, 0.02f, nullptr, 1.0f, 5, CancelCheck(cancelled)),
                 Error);
}

}  // namespace
}  // namespace pm::test
