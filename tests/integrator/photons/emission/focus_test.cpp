// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Scenes that reach far beyond what is seen: photons are aimed at where gather rays end, and bring
// what the unaimed bring.
#include "integrator/photons/emission/focus.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "integrator/photons/emission/aimed_emission.h"
#include "integrator/photons/trace/photon_store.h"
#include "integrator/photons/trace/photon_tracer.h"
#include "integrator/transport/frame_renderer.h"
#include "integrator/transport/survey/gather_focus.h"
#include "tests/support/replicates.h"
#include "tests/support/rooms.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

const std::atomic<bool> kNotCancelled{false};

Focus focusOn(const Scene& scene, Vec3d at, double radius) {
    return {Vec3f(at - scene.centre()), static_cast<float>(1 / (radius * radius))};
}

TEST(Focus, LevelsAreBallsEachTwiceAsWide) {
    const Focus focus{{1, 2, 3}, 0.25f};  // radius 2
    for (const auto& [distance, level] : std::vector<std::pair<float, int>>{{0.0f, 0},
                                                                            {1.999f, 0},
                                                                            {2.01f, 1},
                                                                            {3.99f, 1},
                                                                            {4.01f, 2},
                                                                            {7.9f, 2},
                                                                            {8.1f, 3},
                                                                            {2049.0f, 11}})
        EXPECT_EQ(focus.levelAt(Vec3f{1, 2, 3} + normalize(Vec3f{1, -2, 2}) * distance), level)
            << distance;
    EXPECT_EQ(Focus{}.levelAt({1e30f, 0, 0}), 0);
    EXPECT_EQ(powerOfTwo(0), 1.0f);
    EXPECT_EQ(powerOfTwo(5), 32.0f);
}

// A table, a wall and a ball on a ground of that half width.
SceneMaker onGround(double half) {
    SceneMaker maker;
    const std::uint32_t white = maker.diffuse(Rgb(0.5f)), red = maker.diffuse({0.7f, 0.3f, 0.2f});
    maker.quad({-half, 0, half}, {2 * half, 0, 0}, {0, 0, -2 * half}, white);
    maker.box({-1, 0.8, -1}, {1, 0.9, 1}, red, false);
    for (const double x : {-0.95, 0.9})
        for (const double z : {-0.95, 0.9})
            maker.box({x, 0, z}, {x + 0.05, 0.8, z + 0.05}, red, false);
    maker.sphere({1.6, 0.4, 0.5}, 0.4, white);
    maker.quad({-1.5, 0, 1}, {0, 0, -2}, {0, 1.5, 0}, white);
    maker.camera({1, 1.2, 5}, {0, 0.5, 0}, {0, 1, 0}, 35);
    return maker;
}

struct Lamps {
    const char* name;
    std::function<void(SceneMaker&)> add;
};
std::vector<Lamps> lamps() {
    return {
        {"sun",
         [](SceneMaker& m) {
             m.sun({-0.5, -1, -0.3}, Rgb(3.0f), 0.005);
         }},
        {"sky",
         [](SceneMaker& m) {
             m.sky({0.3f, 0.4f, 0.5f});
         }},
        {"point",
         [](SceneMaker& m) {
             m.pointLight({3, 4, 1}, Rgb(10.0f));
         }},
        {"spot far away",
         [](SceneMaker& m) {
             m.spot({12, 5, -9}, {-11, -5, 8}, Rgb(300.0f), 0.3, 0.2);
         }},
        {"area far away",
         [](SceneMaker& m) {
             m.quad({-8, 3, -8}, {2, 0, 0}, {0, 0.5, 2}, m.diffuse({}, {20, 10, 5}));
         }},
        {"ball near and sun",
         [](SceneMaker& m) {
             m.sphere({0.5, 1.5, 0}, 0.1, m.diffuse({}, Rgb(50.0f)));
             m.sun({0.3, -1, 0.2}, Rgb(1.0f), 0);
         }},
    };
}

// Flux that landed in each of some levels, by its channels, and apart on what looks down, which it
// reaches by a bounce.
constexpr std::size_t kLevels = 4, kSums = kLevels * 4;
std::array<double, kSums> landed(const BigVector<Photon>& photons, const Focus& focus) {
    std::array<double, kSums> sums{};
    for (const Photon& photon : photons) {
        const auto level = static_cast<std::size_t>(focus.levelAt(photon.position));
        const std::size_t at = 4 * std::min(level, kLevels - 1);
        for (int c = 0; c < 3; ++c)
            sums[at + static_cast<std::size_t>(c)] += static_cast<double>(photon.flux[c]);
        if (photon.normal.unpack().y < -0.5f) sums[at + 3] += static_cast<double>(photon.flux.r);
    }
    return sums;
}

// Where both can be had.
TEST(Focus, LandsTheFluxOfTheUnaimed) {
    constexpr int kReplicates = 96;
    for (const Lamps& lamp : lamps()) {
        SceneMaker maker = onGround(15);
        lamp.add(maker);
        const auto scene = maker.build();
        const LightSampler lights(*scene);
        const Focus focus = focusOn(*scene, {0, 0.5, 0}, 2);
        const AimedEmission aim = AimedEmission::atFocus(*scene, lights, focus);
        ASSERT_FALSE(aim.empty()) << lamp.name;
        std::array<std::array<std::array<double, kSums>, kReplicates>, 2> all;
        std::array<std::size_t, 2> inFocus{};
        std::array<float, 2> brightest{};
        for (const std::size_t aimed : {0u, 1u})
            for (std::size_t i = 0; i < kReplicates; ++i) {
                PhotonTraceRequest request{PhotonKind::kGlobal, 10'000, i + 1, 0};
                request.aim = aimed ? &aim : nullptr;
                const auto photons =
                    tracePhotons(*scene, lights, request, kNotCancelled, {}).photons;
                all[aimed][i] = landed(photons, focus);
                for (const Photon& photon : photons)
                    if (focus.levelAt(photon.position) == 0) {
                        ++inFocus[aimed];
                        brightest[aimed] = std::max(brightest[aimed], photon.flux.r);
                    }
            }
        double worst = 0;
        for (std::size_t k = 0; k < kSums; ++k) {
            std::array<Moments, 2> m;
            for (const std::size_t aimed : {0u, 1u})
                m[aimed] =
                    momentsOf(kReplicates, [&](std::uint32_t i) { return all[aimed][i][k]; });
            const double sigma = std::hypot(m[0].standardError, m[1].standardError);
            const double z = sigma > 0 ? std::abs(m[1].mean - m[0].mean) / sigma : 0;
            worst = std::max(worst, z);
            EXPECT_LT(z, 4) << fmt::format(
                "{}, sum {}: aimed {:.5f} +- {:.5f}, unaimed {:.5f} +- {:.5f}", lamp.name, k,
                m[1].mean, m[1].standardError, m[0].mean, m[0].standardError);
        }
        const double times = static_cast<double>(inFocus[1]) / static_cast<double>(inFocus[0]);
        fmt::print(
            "    {}: {:.1f} times as many photons in focus, the brightest {:.3f} of the "
            "unaimed ones', largest |z| of the sums {:.2f}\n",
            lamp.name, times, brightest[1] / brightest[0], worst);
        EXPECT_GT(times, 1.5) << lamp.name;
        // Nor are any made that are brighter: far from the focus there are, and their bounces are
        // aimed so that they don't stay so.
        EXPECT_LT(brightest[1], 3 * brightest[0]) << lamp.name;
    }
}

TEST(Focus, IsFoundWhereGatherRaysEnd) {
    const auto focusOf = [](const SceneMaker& maker) {
        const auto scene = maker.build();
        RenderSettings settings = smallFrame(64, 64, IntegratorKind::kPhoton, 1, 3);
        const CancelCheck check(kNotCancelled);
        Focus focus = findGatherFocus(*scene, Camera(*scene, 64, 64), settings, check);
        focus.centre += Vec3f(scene->centre());
        return focus;
    };
    const Focus wide = focusOf(onGround(1000));
    ASSERT_FALSE(wide.isEverywhere());
    EXPECT_LT(length(wide.centre - Vec3f{0, 0.5f, 0}), 1.5f);
    EXPECT_LT(1 / std::sqrt(wide.inverseRadiusSquared), 6.0f);
    EXPECT_GT(1 / std::sqrt(wide.inverseRadiusSquared), 1.0f);
    // A dome as far away as the ground reaches is met by most rays. It reflects nothing, or little.
    for (const float reflectance : {0.0f, 0.05f}) {
        SceneMaker domed = onGround(1000);
        domed.box({-1000, -1, -1000}, {1000, 1000, 1000},
                  domed.diffuse(Rgb(reflectance), Rgb(1.0f)), true);
        const Focus under = focusOf(domed);
        ASSERT_FALSE(under.isEverywhere()) << reflectance;
        EXPECT_LT(length(under.centre - Vec3f{0, 0.5f, 0}), 1.5f) << reflectance;
        EXPECT_LT(1 / std::sqrt(under.inverseRadiusSquared), 6.0f) << reflectance;
    }
    // What few camera paths meet, a leaf seen from its edge, is looked at again by more.
    SceneMaker leaf;
    leaf.quad({-650, -1, 650}, {1300, 0, 0}, {0, 0, -1300}, leaf.diffuse(Rgb(0.5f)));
    leaf.quad({0.06, 0.04, -0.34}, {-0.76, 0.6, -0.66}, {0.53, -0.7, 0.96},
              leaf.diffuse(Rgb(0.4f)));
    leaf.camera({0, 0.05, 3.5}, {0.08, -0.13, 0}, {0, 1, 0}, 45);
    const Focus onLeaf = focusOf(leaf);
    ASSERT_FALSE(onLeaf.isEverywhere());
    EXPECT_LT(length(onLeaf.centre - Vec3f{0.1f, -0.3f, 0.1f}), 1.0f);
    EXPECT_TRUE(focusOf(onGround(5)).isEverywhere());
    EXPECT_TRUE(focusOf(openRoom()).isEverywhere());
}

// Under a table in the sun, on a ground of a thousand times its width.
TEST(Focus, IndirectLightOnAHugeGround) {
    SceneMaker maker = onGround(1000);
    maker.sun({-0.5, -1, -0.3}, Rgb(3.0f), 0.005);
    const auto scene = maker.build();
    const auto regions = squares(32, 32, 8);
    const auto path = replicate(6, [&](std::uint64_t seed) {
        RenderSettings settings = smallFrame(32, 32, IntegratorKind::kPath, 2, 6);
        settings.seed = seed + 100;
        return render(scene, settings, regions);
    });
    const auto photon = replicate(8, [&](std::uint64_t seed) {
        RenderSettings settings = smallFrame(32, 32, IntegratorKind::kPhoton, 4, 3);
        settings.seed = seed;
        return render(scene, settings, regions);
    });
    expectAgreement(photon, path, kIndirect, 0.03, 4, "huge ground");
    expectAgreement(wholeFrames(photon), wholeFrames(path), kIndirect, 0.01, 4, "huge ground");
    const Replicated whole = spread(wholeFrames(photon), 0, kIndirect, 1);
    EXPECT_LT(whole.standardError, 0.02 * whole.mean);
}

// What casts reaches a thousand times as far as what it lights is wide.
TEST(Focus, CausticsOfAHugeMirror) {
    struct Case {
        const char* name;
        std::function<void(SceneMaker&)> add;
        double error;  // of the mean of 5 renders, over it, at most
    };
    const auto ground = [](SceneMaker& maker, const MaterialDescription& material) {
        maker.quad({-400, -1, 400}, {800, 0, 0}, {0, 0, -800}, maker.material(material));
    };
    const Case cases[] = {
        {"mirror, sun",
         [&](SceneMaker& m) {
             ground(m, mirror(0.8f));
             m.sun({0, -1, -1}, Rgb(3.0f), 0.2);
         },
         0.05},
        {"glass, sky",
         [&](SceneMaker& m) {
             ground(m, glass());
             m.sky(Rgb(1.0f));
         },
         0.15},
        {"mirror, lamp",
         [&](SceneMaker& m) {
             ground(m, mirror(0.8f));
             m.sphere({0, 0.5, 1}, 0.3, m.diffuse({}, Rgb(5.0f)));
         },
         0.05},
    };
    for (const Case& c : cases) {
        SceneMaker maker;
        c.add(maker);
        maker.quad({-0.4, -0.95, 0}, {0.8, 0, 0}, {0, 0.6, 0}, maker.diffuse(Rgb(0.5f)));
        maker.camera({0, -0.65, 1.5}, {0, -0.65, 0}, {0, 1, 0}, 25);
        const auto scene = maker.build();
        const auto regions = squares(32, 32, 32);
        const auto renders = [&](IntegratorKind kind, std::uint32_t passes, std::uint32_t level,
                                 std::uint64_t firstSeed) {
            return replicate(5, [&](std::uint64_t seed) {
                RenderSettings settings = smallFrame(32, 32, kind, passes, level);
                settings.seed = seed + firstSeed;
                return render(scene, settings, regions);
            });
        };
        const auto path = renders(IntegratorKind::kPath, 2, 5, 100);
        const auto photon = renders(IntegratorKind::kPhoton, 4, 3, 0);
        // Blur over the edge of the little surface takes a hundredth or two.
        expectAgreement(photon, path, kCaustic, 0.03, 4, c.name);
        const Replicated whole = spread(photon, 0, kCaustic, 1);
        fmt::print("    {}: {:.4f} of path's, standard error {:.4f}\n", c.name,
                   whole.mean / spread(path, 0, kCaustic, 1).mean,
                   whole.standardError / whole.mean);
        EXPECT_LT(whole.standardError, c.error * whole.mean) << c.name;
    }
}

// Photons of one view, for others.
class Kept : public PhotonSink, public PhotonSource {
  public:
    void write(PhotonKind kind, std::uint32_t pass, const PhotonTraceResult& traced,
               const std::atomic<bool>&) override {
        m_traced[{kind, pass}] = traced;
    }
    PhotonTraceResult read(PhotonKind kind, std::uint32_t pass,
                           const std::atomic<bool>&) const override {
        return m_traced.at({kind, pass});
    }

  private:
    std::map<std::pair<PhotonKind, std::uint32_t>, PhotonTraceResult> m_traced;
};

// Estimates are as wide as the photons ask for that are there, not those that the view would have
// had.
TEST(Focus, PhotonsOfAnotherViewWillDo) {
    SceneMaker maker = onGround(200);
    maker.sun({-0.5, -1, -0.3}, Rgb(3.0f), 0.005);
    const auto scene = maker.build();
    maker.camera({-4, 2, -5}, {-0.5, 0.5, 0}, {0, 1, 0}, 45);
    const auto elsewhere = maker.build();
    const auto regions = squares(32, 32, 16);
    constexpr std::uint32_t kPasses = 4, kSamples = 8;
    const auto path = replicate(6, [&](std::uint64_t seed) {
        RenderSettings settings = smallFrame(32, 32, IntegratorKind::kPath, 2, 6);
        settings.seed = seed + 100;
        return render(scene, settings, regions);
    });
    const auto photon = replicate(12, [&](std::uint64_t seed) {
        RenderSettings settings = smallFrame(32, 32, IntegratorKind::kPhoton, kPasses, 3);
        settings.seed = seed;
        Kept kept;
        PlannedRender other(elsewhere, settings, makePlan(*elsewhere, settings));
        for (std::uint32_t pass = 0; pass < kPasses; ++pass)
            other.photons().traceInto(kept, pass, kNotCancelled, {});
        PlannedRender render(scene, settings, makePlan(*scene, settings));
        render.photons().readFrom(kept);
        return render.render(regions, kSamples);
    });
    expectAgreement(photon, path, kIndirect, 0.02, 4, "another view");
    expectAgreement(wholeFrames(photon), wholeFrames(path), kIndirect, 0.01, 4, "another view");
    const Replicated whole = spread(wholeFrames(photon), 0, kIndirect, 1);
    EXPECT_LT(whole.standardError, 0.02 * whole.mean);
}

}  // namespace
}  // namespace pm::test
