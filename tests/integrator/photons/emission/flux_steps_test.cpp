// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Photons drawn in proportion to their flux.
#include "integrator/photons/emission/flux_steps.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "tests/support/statistics.h"

namespace pm::test {
namespace {

std::vector<Photon> spread(std::size_t count) {
    Random random(3);
    std::vector<Photon> photons(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec2f at = random.next2D();
        // A third is black; one is as bright as a tenth of all.
        const float flux = i == 100 ? 0.1f * static_cast<float>(count) : random.next() - 0.33f;
        photons[i] = {{at.x, at.y, 0}, Rgb(std::max(flux, 0.0f)), PackedNormal({0, 0, 1})};
    }
    return photons;
}

// Each as often as its flux says: the next lower or higher whole number.
TEST(FluxSteps, DrawEachInProportion) {
    for (const std::size_t size : {std::size_t{1}, std::size_t{1000}, std::size_t{40'000}}) {
        const PhotonMap map(size == 1 ? std::vector<Photon>{{{}, Rgb(1), PackedNormal({0, 0, 1})}}
                                      : spread(size));
        double flux = 0;
        for (std::uint32_t i = 0; i < size; ++i) flux += channelSum(map.photon(i).flux);
        for (const float u : {0.0f, 0.3f, 0x1.fffffep-1f}) {
            constexpr std::size_t kCount = 3000;
            const DrawnByFlux drawn = drawBySteps(map, kCount, u);
            EXPECT_NEAR(drawn.flux, flux, 1e-12 * flux);
            ASSERT_EQ(drawn.photons.size(), kCount);
            std::map<std::tuple<float, float>, int> times;
            for (const auto& [photon, share] : drawn.photons) {
                ++times[{photon.position.x, photon.position.y}];
                EXPECT_NEAR(share, channelSum(photon.flux) / flux, 1e-12);
            }
            for (std::uint32_t i = 0; i < size; ++i) {
                const Photon photon = map.photon(i);
                const double expected = kCount * channelSum(photon.flux) / flux;
                const int found = times[{photon.position.x, photon.position.y}];
                ASSERT_LT(std::abs(found - expected), 1 + 1e-9) << size << ", photon " << i;
            }
        }
    }
}

// Where the steps fall on the photons laid end to end.
TEST(FluxSteps, DrawWhereTheStepsFall) {
    const PhotonMap map(spread(40'000));
    constexpr std::size_t kCount = 3000;
    for (const float u : {0.0f, 0.3f, 0x1.fffffep-1f}) {
        const DrawnByFlux drawn = drawBySteps(map, kCount, u);
        double upTo = 0;
        std::size_t next = 0;
        for (std::uint32_t i = 0; i < map.size(); ++i) {
            const Photon photon = map.photon(i);
            upTo += channelSum(photon.flux);
            for (; next < kCount; ++next) {
                const double place = (static_cast<double>(next) + u) * drawn.flux / kCount;
                if (place >= upTo - 1e-9 * drawn.flux) break;
                ASSERT_EQ(drawn.photons[next].photon.position, photon.position) << next;
            }
            // So near an end that rounding decides.
            if (next < kCount &&
                (static_cast<double>(next) + u) * drawn.flux / kCount < upTo + 1e-9 * drawn.flux)
                ++next;
        }
        EXPECT_EQ(next, kCount);
    }
}

TEST(FluxSteps, TheSameBitsForAnyNumberOfThreads) {
    const PhotonMap map(spread(40'000));
    std::array<DrawnByFlux, 2> drawn;
    for (const int threads : {1, 3})
        tbb::task_arena(threads).execute(
            [&] { drawn[threads > 1] = drawBySteps(map, 2048, 0.4f); });
    EXPECT_EQ(drawn[0].flux, drawn[1].flux);
    for (std::size_t i = 0; i < 2048; ++i) {
        EXPECT_EQ(drawn[0].photons[i].photon.position, drawn[1].photons[i].photon.position);
        EXPECT_EQ(drawn[0].photons[i].share, drawn[1].photons[i].share);
    }
}

TEST(FluxSteps, DrawNothingInTheDark) {
    EXPECT_TRUE(drawBySteps(PhotonMap(std::vector<Photon>{}), 10, 0).photons.empty());
    EXPECT_TRUE(drawBySteps(PhotonMap(std::vector<Photon>(20'000)), 10, 0).photons.empty());
}

}  // namespace
}  // namespace pm::test
