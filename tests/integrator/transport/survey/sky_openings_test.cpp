// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Rooms lit through windows: photons from afar are aimed at these, and bring what the unaimed
// bring.
#include "integrator/transport/survey/sky_openings.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/photons/emission/aimed_emission.h"
#include "integrator/photons/emission/sky_parts.h"
#include "integrator/photons/trace/photon_tracer.h"
#include "tests/support/statistics.h"
#include "tests/support/window_room.h"

namespace pm::test {
namespace {

const std::atomic<bool> kNotCancelled{false};

SkyOpenings openingsOf(const Scene& scene) {
    // One seed in six has a second, small ball beside a window.
    RenderSettings settings = smallFrame(64, 64, IntegratorKind::kPhoton, 1, 3);
    settings.seed = 3;
    return findSkyOpenings(scene, Camera(scene, 64, 64), settings, CancelCheck(kNotCancelled));
}

SceneMaker whiteRoom(double half, double middle) {
    return windowRoom(half, Rgb(0.6f), Rgb(0.7f), middle);
}

TEST(SkyOpenings, WindowIsFound) {
    for (const auto& [half, middle] : {std::pair{0.3, 0.0}, {0.15, -0.6}, {0.04, 0.5}}) {
        SceneMaker maker = whiteRoom(half, middle);
        maker.sky(Rgb(1.0f));
        const auto scene = maker.build();
        const SkyOpenings openings = openingsOf(*scene);
        ASSERT_EQ(openings.balls.size(), 1u) << half;
        const Vec3d at = openings.balls[0].centre + scene->centre();
        const double radius = openings.balls[0].radius;
        EXPECT_LT(length(at - Vec3d{middle, 1, 0}), 0.6 * half) << half;
        // About the window's: half of its side to half of its diagonal.
        EXPECT_GT(radius, 0.8 * half);
        EXPECT_LT(radius, 1.6 * half);
        double total = 0, below = 0;
        for (std::uint32_t part = 0; part < SkyParts::kCount; ++part) {
            const auto share = static_cast<double>(openings.seenShare[part]);
            total += share;
            if (part < SkyParts::kCount / 2) below += share;
        }
        EXPECT_NEAR(total, 1, 1e-4);
        EXPECT_EQ(below, 0);
    }
}

TEST(SkyOpenings, TwoWindowsAreFound) {
    SceneMaker maker = whiteRoom(0.15, -0.6);
    // One in the wall towards -z, which the camera sees: the wall is made anew around it.
    maker.description.instances.erase(maker.description.instances.begin() + 1);
    const auto wall = maker.diffuse(Rgb(0.7f));
    maker.quad({-1, -1, -1}, {2, 0, 0}, {0, 0.9, 0}, wall);
    maker.quad({-1, 0.3, -1}, {2, 0, 0}, {0, 0.7, 0}, wall);
    maker.quad({-1, -0.1, -1}, {1.4, 0, 0}, {0, 0.4, 0}, wall);
    maker.quad({0.8, -0.1, -1}, {0.2, 0, 0}, {0, 0.4, 0}, wall);
    maker.sky(Rgb(1.0f));
    const auto scene = maker.build();
    const SkyOpenings openings = openingsOf(*scene);
    ASSERT_EQ(openings.balls.size(), 2u);
    for (const Vec3d& window : {Vec3d{-0.6, 1, 0}, Vec3d{0.6, 0.1, -1}}) {
        double nearest = 1e9;
        for (const Caster& ball : openings.balls)
            nearest = std::min(nearest, length(ball.centre + scene->centre() - window));
        EXPECT_LT(nearest, 0.15) << window.x;
    }
}

TEST(SkyOpenings, NoneInTheOpenOrWithoutASky) {
    SceneMaker closed = windowRoom(0.2, Rgb(0.5f), Rgb(0.5f));
    closed.sun({0.1, -1, 0}, Rgb(1.0f), 0);
    EXPECT_TRUE(openingsOf(*closed.build()).balls.empty());
    SceneMaker open;
    open.quad({-1, -1, 1}, {2, 0, 0}, {0, 0, -2}, open.diffuse(Rgb(0.5f)));
    open.camera({0, 1, 3}, {0, -1, 0}, {0, 1, 0}, 40);
    open.sky(Rgb(1.0f));
    EXPECT_TRUE(openingsOf(*open.build()).balls.empty());
}

// Flux by channels that landed on the floor, on what looks down, and on all else inside; and how
// many photons.
constexpr std::size_t kSums = 9;
struct Landed {
    std::array<double, kSums> sums{};
    double photons = 0;
};
Landed landedInside(const BigVector<Photon>& photons, const Scene& scene) {
    Landed landed;
    for (const Photon& photon : photons) {
        const Vec3f p = photon.position + Vec3f(scene.centre());
        const Vec3f normal = photon.normal.unpack();
        // On the walls' outsides normals look away from the room.
        if (dot(normal, p) > 0.0f) continue;
        const std::size_t at = normal.y > 0.5f ? 0 : normal.y < -0.5f ? 3 : 6;
        for (int c = 0; c < 3; ++c)
            landed.sums[at + static_cast<std::size_t>(c)] += static_cast<double>(photon.flux[c]);
        ++landed.photons;
    }
    return landed;
}

TEST(SkyOpenings, LandsTheFluxOfTheUnaimed) {
    constexpr std::uint32_t kReplicates = 64;
    SceneMaker maker = whiteRoom(0.2, 0.4);
    maker.sky({1.0f, 2.0f, 3.0f});
    maker.sun({-0.4, -1, 0.2}, {5.0f, 4.0f, 3.0f}, 0.05);
    maker.quad({-0.9, 0.95, -0.5}, {0.2, 0, 0}, {0, 0, 0.2}, maker.diffuse({}, Rgb(1.0f)));
    const auto scene = maker.build();
    const LightSampler lights(*scene);
    const SkyOpenings openings = openingsOf(*scene);
    ASSERT_EQ(openings.balls.size(), 1u);
    const AimedEmission aim =
        AimedEmission::atOpenings(*scene, lights, openings.balls, openings.seenShare);
    std::array<std::vector<Landed>, 2> all;
    for (const std::size_t aimed : {0u, 1u})
        for (std::uint32_t i = 0; i < kReplicates; ++i) {
            PhotonTraceRequest request{PhotonKind::kGlobal, 20'000, i + 1, 0};
            request.aim = aimed ? &aim : nullptr;
            all[aimed].push_back(landedInside(
                tracePhotons(*scene, lights, request, kNotCancelled, {}).photons, *scene));
        }
    const auto moments = [&](std::size_t aimed, const auto& value) {
        return momentsOf(kReplicates, [&](std::uint32_t i) { return value(all[aimed][i]); });
    };
    double gain = 0;
    for (std::size_t k = 0; k < kSums; ++k) {
        const auto sum = [k](const Landed& l) { return l.sums[k]; };
        const Moments unaimed = moments(0, sum), aimed = moments(1, sum);
        EXPECT_LT(std::abs(aimed.mean - unaimed.mean),
                  4 * std::hypot(aimed.standardError, unaimed.standardError))
            << k << ": " << aimed.mean << " for " << unaimed.mean;
        gain += unaimed.variance / aimed.variance / kSums;
    }
    const auto photons = [](const Landed& l) { return l.photons; };
    const double times = moments(1, photons).mean / moments(0, photons).mean;
    fmt::print("    {:.1f} times as many photons inside, {:.1f} times less variance\n", times,
               gain);
    EXPECT_GT(times, 4);
    // By 16 seeds 1.4 to 6.
    EXPECT_GT(gain, 1.2);
}

}  // namespace
}  // namespace pm::test
