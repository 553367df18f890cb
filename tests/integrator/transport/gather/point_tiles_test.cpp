// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Gather points are there while somebody may ask for them, and no longer.
#include "integrator/transport/gather/point_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <span>
#include <vector>

#include "integrator/photons/trace/photon_tracer.h"
#include "integrator/transport/gather/gather_points.h"
#include "tests/support/rooms.h"

namespace pm::test {
namespace {

const std::atomic<bool> kNotCancelled{false};
constexpr std::int32_t kSize = 640;
constexpr float kSpacing = 2.5f, kRadius = 4.0f;

// No pixel asks for a tile beyond those it is said to ask, nor for one that it is not in reach of:
// by that tiles are forgotten.
TEST(PointTiles, ReachAndWhoAsksAreTheSame) {
    for (const float spacing : {kSpacing, 32.0f}) {
        const PointTiles tiles(1000, 300, spacing, 1.6f * spacing);
        for (const Rect& region :
             {Rect{0, 0, 8, 8}, Rect{96, 40, 128, 72}, Rect{992, 296, 1000, 304},
              Rect{-40, -16, -8, 8}, Rect{0, 0, 1000, 300}}) {
            const Rect asked = tiles.asked(region);
            for (std::size_t tile = 0; tile < tiles.count(); ++tile) {
                const auto x = static_cast<std::int32_t>(tile) % tiles.across();
                const auto y = static_cast<std::int32_t>(tile) / tiles.across();
                EXPECT_TRUE(intersect(tiles.reach(tile), region).empty() || asked.contains(x, y))
                    << tile;
                // The tile's own pixels, and those so near that points of it count.
                const auto first = [&](std::int32_t at) {
                    return (static_cast<float>(at * PointTiles::kSide) - PointTiles::kMargin) *
                           spacing;
                };
                const float reach = 1.6f * spacing + 4.0f;
                const Rect near{static_cast<std::int32_t>(first(x) - reach),
                                static_cast<std::int32_t>(first(y) - reach),
                                static_cast<std::int32_t>(first(x + 1) + reach),
                                static_cast<std::int32_t>(first(y + 1) + reach)};
                EXPECT_EQ(intersect(near, tiles.reach(tile)), near) << tile;
            }
        }
    }
}

TEST(PointTiles, MostAtOnceFollowsTheOrder) {
    const PointTiles tiles(4096, 4096, 8.0f, 12.8f);  // 33 x 33
    const Rect all{0, 0, 4096, 4096};
    std::vector<Rect> rows, scattered;
    for (std::int32_t y = 0; y < 4096; y += 64)
        for (std::int32_t x = 0; x < 4096; x += 64) rows.push_back({x, y, x + 64, y + 64});
    for (std::size_t i = 0; i < rows.size(); ++i)
        scattered.push_back(rows[(i * 1597) % rows.size()]);
    // Row by row, two rows of tiles are open, and what a bucket begins of a third.
    EXPECT_GE(tiles.mostAtOnce(rows, all, 1), 33u);
    EXPECT_LE(tiles.mostAtOnce(rows, all, 1), 3 * 33u);
    EXPECT_GT(tiles.mostAtOnce(scattered, all, 1), 800u);
    EXPECT_LE(tiles.mostAtOnce(scattered, all, 8), tiles.count());
    EXPECT_GT(tiles.mostAtOnce(rows, all, 8), tiles.mostAtOnce(rows, all, 1));
}

// What samples 16 pixels apart find, bucket by bucket; done buckets are forgotten where asked for.
std::vector<float> found(const GatherPoints& points, const Scene& scene, const Camera& camera,
                         std::span<const Rect> regions, const Rect& all, bool forgets) {
    std::vector<float> result(static_cast<std::size_t>(kSize / 16 * (kSize / 16)));
    for (const Rect& region : regions) {
        for (std::int32_t y = region.y0; y < region.y1; y += 16)
            for (std::int32_t x = region.x0; x < region.x1; x += 16) {
                Surface surface;
                if (!scene.intersect(camera.ray({static_cast<double>(x), static_cast<double>(y)}),
                                     surface))
                    continue;
                GatherPoints::Estimate estimate;
                const Vec3f normal = surface.geometricNormal;
                points.estimate({{static_cast<float>(x), static_cast<float>(y)},
                                 surface.position,
                                 normal,
                                 normal,
                                 surface.offset},
                                estimate);
                result[static_cast<std::size_t>(y / 16 * (kSize / 16) + x / 16)] =
                    estimate.irradiance.wide.g;
            }
        if (forgets) points.forget(region, all);
    }
    return result;
}

// The same irradiance, and no more memory than is planned for, of which the whole takes four times
// as much.
TEST(PointTiles, AreForgottenWhenDone) {
    SceneMaker maker = openRoom();
    ceilingLamp(maker, 0.5, Rgb(8.0f));
    maker.camera({0, 0, 0.9}, {0, 0, -1}, {0, 1, 0}, 50);
    const auto scene = maker.build();
    const Camera camera(*scene, kSize, kSize);
    const PhotonMap map(
        tracePhotons(*scene, LightSampler(*scene), {PhotonKind::kGlobal, 10'000}, kNotCancelled, {})
            .photons);
    const IrradianceSites sites(*scene, map, 0.2f);
    const Rect all{0, 0, kSize, kSize};
    std::vector<Rect> regions;
    for (std::int32_t y = 0; y < kSize; y += 32)
        for (std::int32_t x = 0; x < kSize; x += 32) regions.push_back({x, y, x + 32, y + 32});
    const GatherPoints::Request request{kSize, kSize, kSpacing, 1};
    const GatherPoints kept(*scene, camera, sites, request);
    const auto wanted = found(kept, *scene, camera, regions, all, false);
    const GatherPoints forgotten(*scene, camera, sites, request);
    EXPECT_EQ(wanted, found(forgotten, *scene, camera, regions, all, true));
    EXPECT_GT(*std::ranges::max_element(wanted), 0.0f);
    const std::uint64_t planned =
        GatherPoints::memoryBytes(kSize, kSize, kSpacing, regions, all, 1);
    EXPECT_LE(forgotten.memoryBytes(), planned);
    // Tiles are as narrow as what is allowed for samples beside their pixels, here.
    EXPECT_LT(planned, 3 * forgotten.memoryBytes());
    EXPECT_LT(4 * forgotten.memoryBytes(), kept.memoryBytes());
    EXPECT_LE(kept.memoryBytes(), GatherPoints::memoryBytes(kSize, kSize, kSpacing, all));
}

}  // namespace
}  // namespace pm::test
