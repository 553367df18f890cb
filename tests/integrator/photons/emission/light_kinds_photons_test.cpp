// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Photons of spots, directional lights and environments: the flux that they carry, unaimed and
// aimed, where it lands, and how many of the aimed ones hit.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "integrator/lights/box_shadow.h"
#include "integrator/photons/emission/aimed_emission.h"
#include "integrator/photons/trace/photon_tracer.h"
#include "integrator/sampling/sampler.h"
#include "tests/support/aimed.h"
#include "tests/support/hit_share.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"
#include "tests/support/sky_picture.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr double kPiD = std::numbers::pi;
// Walls around [-1, 1]^3 but for the upper one and the front.
SceneMaker openBox() {
    SceneMaker maker;
    maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(0.5f)), true);
    maker.description.instances.erase(maker.description.instances.begin() + 1);
    maker.description.instances.pop_back();
    return maker;
}

struct TestLight {
    const char* name;
    std::function<void(SceneMaker&)> add;
};

std::vector<TestLight> testLights() {
    return {
        {"spot",
         [](SceneMaker& m) {
             m.spot({-0.3, 0.8, 0.2}, {0.4, -1, 0}, {1, 2, 3}, 0.9, 0.5);
         }},
        {"spot outside",
         [](SceneMaker& m) {
             m.spot({0.3, 6, 0.4}, {0, -1, -0.1}, {30, 20, 10}, 1.2, 0.2);
         }},
        {"spot outside, narrower than the scene",
         [](SceneMaker& m) {
             m.spot({0.3, 6, 0.4}, {0, -1, -0.05}, {30, 20, 10}, 0.12, 0.1);
         }},
        {"parallel light",
         [](SceneMaker& m) {
             m.sun({0.2, -1, -0.5}, {3, 2, 1}, 0);
         }},
        {"sun",
         [](SceneMaker& m) {
             m.sun({0.2, -1, -0.5}, {3, 2, 1}, 0.15);
         }},
        {"even sky",
         [](SceneMaker& m) {
             m.sky({0.5f, 1, 2});
         }},
        {"sunny sky", [](SceneMaker& m) { m.sky(Rgb(1.0f), sunnySky(), aTurn()); }},
        {"sphere with a texture",
         [](SceneMaker& m) {
             MaterialDescription lamp;
             lamp.emission = {1, 2, 3};
             lamp.emissionTexture = 0;
             m.description.textures = sunnySky();
             m.sphere({-0.3, 0.4, 0.2}, 0.3, m.material(lamp));
             m.description.instances.back().transform = aTurn();
         }},
        {"all of them",
         [](SceneMaker& m) {
             m.spot({-0.3, 0.8, 0.2}, {0.4, -1, 0}, {1, 2, 3}, 0.9, 0.5);
             m.sun({0.2, -1, -0.5}, {3, 2, 1}, 0.05);
             m.sun({0, -1, 0}, {1, 2, 1}, 0);
             m.sky({0.5f, 0.2f, 0.2f});
             m.pointLight({0.3, 0.3, 0.3}, Rgb(0.2f));
         }},
    };
}

std::shared_ptr<const Scene> build(const TestLight& light) {
    SceneMaker maker = openBox();
    light.add(maker);
    maker.sphere({0.2, -0.5, 0.1}, 0.25, maker.material(glass()));
    maker.box({-0.7, -0.9, -0.3}, {-0.4, -0.6, 0.4}, maker.material(mirror()), false);
    return maker.build();
}

// Sums over the photons of a trace: flux by channel, red flux by place and by side.
constexpr std::size_t kSums = 8;
using Sums = std::array<double, kSums>;
Sums sumsOf(std::span<const Photon> photons) {
    Sums sums{};
    for (const Photon& p : photons) {
        const auto r = static_cast<double>(p.flux.r);
        sums[0] += r;
        sums[1] += static_cast<double>(p.flux.g);
        sums[2] += static_cast<double>(p.flux.b);
        for (int axis = 0; axis < 3; ++axis)
            sums[static_cast<std::size_t>(3 + axis)] += r * static_cast<double>(p.position[axis]);
        sums[6] += r * static_cast<double>(p.position.x * p.position.z);
        sums[7] += r * static_cast<double>(p.normal.unpack().y);
    }
    return sums;
}

struct Spread {
    Sums mean{}, squaredError{};
};

Spread spreadOf(int count, const std::function<Sums(std::uint64_t seed)>& one) {
    std::vector<Sums> all;
    Spread spread;
    for (int i = 0; i < count; ++i) all.push_back(one(static_cast<std::uint64_t>(i) + 10));
    for (std::size_t k = 0; k < kSums; ++k) {
        for (const Sums& s : all) spread.mean[k] += s[k] / count;
        for (const Sums& s : all)
            spread.squaredError[k] +=
                (s[k] - spread.mean[k]) * (s[k] - spread.mean[k]) / (count * (count - 1.0));
    }
    return spread;
}

// Of what unaimed emission lands as caustics: flux by channel, where, and on which side.
TEST(LightKindPhotons, AimedLandTheFluxOfTheUnaimed) {
    constexpr int kReplicates = 24;
    for (const TestLight& light : testLights()) {
        const Aimed aimed(build(light));
        ASSERT_FALSE(aimed.aim.empty()) << light.name;
        const auto spread = [&](bool aim, std::uint64_t photons) {
            return spreadOf(kReplicates, [&](std::uint64_t seed) {
                return sumsOf(aimed.trace(PhotonKind::kCaustic, photons, seed, aim).photons);
            });
        };
        const Spread want = spread(false, 10'000), got = spread(true, 3'000);
        for (std::size_t k = 0; k < kSums; ++k) {
            const double sigma = std::sqrt(want.squaredError[k] + got.squaredError[k]);
            EXPECT_LT(std::abs(got.mean[k] - want.mean[k]), 4 * sigma)
                << fmt::format("{}, sum {}: aimed {:.5f} +- {:.5f}, unaimed {:.5f} +- {:.5f}",
                               light.name, k, got.mean[k], std::sqrt(got.squaredError[k]),
                               want.mean[k], std::sqrt(want.squaredError[k]));
        }
        // A tolerance that is as large as what is tested would test nothing.
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_LT(std::sqrt(got.squaredError[k]), 0.03 * got.mean[k]) << light.name;
            EXPECT_LT(std::sqrt(want.squaredError[k]), 0.05 * want.mean[k]) << light.name;
        }
    }
}

TEST(LightKindPhotons, EnergyIsConserved) {
    for (const TestLight& light : testLights()) {
        const Aimed aimed(build(light));
        for (const bool aim : {false, true})
            for (const PhotonKind kind : {PhotonKind::kGlobal, PhotonKind::kCaustic}) {
                const PhotonBalance b = aimed.trace(kind, 20'000, 1, aim).balance;
                EXPECT_GT(b.fluxEmitted, 0) << light.name;
                EXPECT_GT(b.fluxEscaped, 0) << light.name;
                EXPECT_NEAR((b.fluxAbsorbed + b.fluxEscaped + b.fluxLost) / b.fluxEmitted, 1, 1e-6)
                    << light.name;
            }
    }
}

// Mean flux of an emitted photon, by channel, over what it should be.
double emitted(const Scene& scene, bool aim, double& standardError) {
    const LightSampler lights(scene);
    const AimedEmission aimed(scene, lights);
    double sum = 0, squares = 0;
    constexpr int kPhotons = 200'000;
    Random random(3);
    for (int i = 0; i < kPhotons; ++i) {
        AimedPhoton photon;
        const Vec2f choice = random.next2D(), point = random.next2D(), direction = random.next2D();
        const bool good = aim ? aimed.emit(choice, point, direction, photon)
                              : lights.emit(choice.x, point, direction, photon);
        const double flux = good ? static_cast<double>(photon.flux.g) : 0;
        sum += flux / kPhotons;
        squares += flux * flux / kPhotons;
    }
    standardError = std::sqrt(std::max(0.0, squares - sum * sum) / kPhotons);
    return sum;
}

// A spot emits the integral of its intensity; what comes from afar, irradiance times the box that
// the light sees. In all, whichever way photons are aimed.
TEST(LightKindPhotons, EmitTheFluxOfTheLight) {
    const Vec3d half{1, 1, 1};
    const auto shadow = [&](const Vec3d& d) { return BoxShadow(half, normalize(d)).area(); };
    // Of a box of side 2, over all directions: 4 pi times a quarter of its surface.
    const std::array<std::pair<std::size_t, double>, 4> want = {
        {{0, 2 * 2 * kPiD * ((1 - std::cos(0.4)) + 0.5 * (std::cos(0.4) - std::cos(0.9)))},
         {3, 2 * shadow({0.2, -1, -0.5})},
         {4, 0},
         {5, 4 * kPiD * 6}}};
    for (const auto& [index, flux] : want) {
        const TestLight light = testLights()[index];
        const auto scene = build(light);
        double expected = flux;
        if (index == 4) {  // radiance times the mean over the disc
            const double cosine = std::cos(0.15);
            double sum = 0;
            const Frame frame{normalize(Vec3f{0.2f, -1.0f, -0.5f})};
            constexpr int kSteps = 200;
            for (int i = 0; i < kSteps; ++i)
                for (int j = 0; j < kSteps; ++j)
                    sum += shadow(Vec3d(frame.toWorld(
                               sampleUniformCone({(static_cast<float>(i) + 0.5f) / kSteps,
                                                  (static_cast<float>(j) + 0.5f) / kSteps},
                                                 static_cast<float>(1 - cosine))))) /
                           (kSteps * kSteps);
            expected = 2 / (kPiD * (1 - cosine * cosine)) * 2 * kPiD * (1 - cosine) * sum;
        }
        for (const bool aim : {false, true}) {
            double error;
            const double mean = emitted(*scene, aim, error);
            EXPECT_NEAR(mean / expected, 1, 4 * error / expected + 1e-4) << light.name << aim;
            EXPECT_LT(error, 0.02 * expected) << light.name << aim;
        }
    }
}

// Global photons on a floor bring the irradiance that next-event estimation finds there: E cos, and
// what a spot's closed form says; the mean over a floor that they all reach.
TEST(LightKindPhotons, LandAsIrradiance) {
    struct Case {
        const char* name;
        std::function<void(SceneMaker&)> add;
        double flux;  // on the floor of side 2, W
    };
    const std::array<Case, 3> cases = {
        {{"parallel light",
          [](SceneMaker& m) {
              m.sun({0.5, -1, 0}, Rgb(2.0f), 0);
          },
          2 * 4 / std::sqrt(1.25)},
         {"sky", [](SceneMaker& m) { m.sky(Rgb(1.0f)); }, kPiD * 4},
         {"spot",
          [](SceneMaker& m) {
              m.spot({0, 1, 0}, {0, -1, 0}, Rgb(1.0f), 0.7, 0.3);
          },
          2 * kPiD * ((1 - std::cos(0.4)) + 0.5 * (std::cos(0.4) - std::cos(0.7)))}}};
    for (const Case& c : cases) {
        SceneMaker maker;
        maker.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, maker.diffuse(Rgb(0.0f, 0.5f, 0.5f)));
        // So high that it hides next to nothing of the sky.
        maker.quad({-1e-3, 3, 1e-3}, {2e-3, 0, 0}, {0, 0, -2e-3}, maker.diffuse(Rgb(0.5f)));
        c.add(maker);
        const Aimed aimed(maker.build(), false);
        const Spread got = spreadOf(16, [&](std::uint64_t seed) {
            Sums sums{};
            for (const Photon& p : aimed.trace(PhotonKind::kGlobal, 20'000, seed, false).photons)
                if (p.position.y < 0 && p.normal.unpack().y > 0.5f)
                    sums[0] += static_cast<double>(p.flux.g);
            return sums;
        });
        const double error = std::sqrt(got.squaredError[0]);
        EXPECT_LT(std::abs(got.mean[0] - c.flux), 4 * error + 1e-4 * c.flux)
            << c.name << ": " << got.mean[0] << " of " << c.flux << " +- " << error;
        EXPECT_LT(error, 0.01 * c.flux) << c.name;
    }
}

// A glass that fills 1/1000 of a spot's solid angle, or of what light from afar sees of the scene,
// is hit by at least half of the photons aimed at it.
TEST(LightKindPhotons, SmallGlassIsHit) {
    const std::array<std::pair<const char*, std::function<void(SceneMaker&)>>, 4> lights = {
        {{"spot",
          [](SceneMaker& m) {
              m.spot({0, 0, 2.9}, {0, 0.3, -3}, Rgb(1.0f), 0.7, 0.7);
          }},
         {"parallel light",
          [](SceneMaker& m) {
              m.sun({0.3, -0.2, -1}, Rgb(1.0f), 0);
          }},
         {"sun",
          [](SceneMaker& m) {
              m.sun({0.3, -0.2, -1}, Rgb(1.0f), 0.00465);
          }},
         {"sky", [](SceneMaker& m) { m.sky(Rgb(1.0f), sunnySky(), aTurn()); }}}};
    for (const auto& [name, add] : lights)
        for (const bool asBox : {false, true})
            for (const Vec3d& at : {Vec3d{0, 0, 0}, {0.9, 0.7, -0.8}}) {
                SceneMaker maker;
                // Specks that make the scene wide and hide nothing.
                for (const Vec3d& corner : {Vec3d(-3), Vec3d(2.999)})
                    maker.quad(corner, {1e-3, 0, 0}, {0, 1e-3, 1e-3}, maker.diffuse(Rgb(0.5f)));
                add(maker);
                // Spot: 2 pi (1 - cos 0.7) sr. Else: some 40 of area.
                const double d = 2.9 - at.z;
                const bool spot = std::string(name) == "spot";
                const double radius = spot ? d * std::sqrt(2 * (1 - std::cos(0.7)) / 1000)
                                           : std::sqrt(40.0 / 1000 / kPiD);
                const double h = radius * 0.77;
                const auto material = maker.material(glass());
                if (asBox)
                    maker.box(at - Vec3d(h), at + Vec3d(h), material, false);
                else
                    maker.sphere(at, radius, material);
                EXPECT_GE(hitShare(maker, 20'000), asBox ? 0.5 : 0.9)
                    << name << " " << asBox << " " << at.x;
            }
}

// Of an even sky only what comes in by a window casts caustics: a pilot finds it, and the unaimed
// share of what comes from elsewhere stays.
TEST(LightKindPhotons, AimsFromTheSkyThatCountsOnly) {
    SceneMaker maker;
    maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(0.5f)), true);
    maker.description.instances.erase(maker.description.instances.begin() + 1);  // its ceiling
    maker.sphere({0.2, -0.5, 0.1}, 0.25, maker.material(glass()));
    maker.sky(Rgb(1.0f));
    const auto scene = maker.build();
    const Aimed guess(scene, false), learned(scene);
    const auto share = [](const Aimed& aimed) {
        const PhotonTraceResult r = aimed.trace(PhotonKind::kCaustic, 50'000, 5, true);
        return static_cast<double>(r.balance.stored) / static_cast<double>(r.balance.emitted);
    };
    EXPECT_LT(share(guess), 0.3);
    EXPECT_GT(share(learned), 2 * share(guess));
    EXPECT_TRUE(guess.aim.sky().empty());
    const auto worth = [&](const Vec3f& d) {
        return learned.aim.sky().worth(SkyParts::partOf(normalize(d)));
    };
    EXPECT_GT(worth({0.1f, 1.0f, 0.1f}), 0.7f);
    EXPECT_LT(worth({0.5f, -0.5f, 0.1f}), 0.3f);
    EXPECT_LT(worth({-1.0f, 0.1f, 0.0f}), 0.3f);
}

// Casters beside a spot's cone get none of its photons.
TEST(LightKindPhotons, SpotsLeaveOutWhatTheyDoNotLight) {
    SceneMaker maker = openBox();
    maker.spot({0, 0.9, 0}, {0.5, -1, 0}, Rgb(1.0f), 0.3, 0.1);
    maker.sphere({0.7, -0.6, 0}, 0.2, maker.material(glass()));
    maker.sphere({-0.7, -0.6, 0}, 0.2, maker.material(glass()));
    const Aimed aimed(maker.build(), false);
    Random random(1);
    std::array<int, 2> counts{};
    for (int i = 0; i < 10'000; ++i) {
        AimedPhoton photon;
        const Vec2f choice = random.next2D(), point = random.next2D();
        if (!aimed.aim.emit(choice, point, random.next2D(), photon)) continue;
        if (photon.caster != kNoCaster)
            ++counts[aimed.aim.casters()[photon.caster].centre.x > aimed.scene->centre().x ? 1 : 0];
    }
    EXPECT_EQ(counts[0], 0);
    EXPECT_GT(counts[1], 9'000);
}

}  // namespace
}  // namespace pm::test
