// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Gather points bring what each camera sample's own gather rays would bring, in rooms where
// irradiance changes within a few pixels.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <vector>

#include "integrator/transport/frame_renderer.h"
#include "tests/support/replicates.h"
#include "tests/support/rooms.h"

namespace pm::test {
namespace {

const std::atomic<bool> kNotCancelled{false};
constexpr std::int32_t kSize = 48, kRegion = 8;

std::vector<Room> tightRooms() {
    const auto lit = [] {
        SceneMaker maker = openRoom();
        ceilingLamp(maker, 0.3, Rgb(16.0f));
        return maker;
    };
    const auto white = [](SceneMaker& m) { return m.diffuse(Rgb(0.8f)); };
    const auto red = [](SceneMaker& m) { return m.diffuse({0.8f, 0.1f, 0.1f}); };
    SceneMaker corners = lit();
    corners.box({-0.8, -1, -0.9}, {-0.3, 0.2, -0.4}, white(corners), false);
    corners.box({0.2, -1, -0.6}, {0.6, -0.4, -0.2}, red(corners), false);
    corners.quad({-0.3, -1, 0.5}, {0.6, 0, 0}, {0, 0.3, 0}, red(corners));

    SceneMaker curved = lit();
    curved.sphere({-0.4, -0.6, 0}, 0.4, white(curved));
    curved.meshSphere({0.5, -0.5, -0.2}, 0.35, white(curved), false, 24);
    curved.sphere({0.2, -0.9, 0.5}, 0.1, red(curved));

    SceneMaker small = lit();
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) {
            const Vec3d at{-0.8 + 0.2 * i, -1, -0.8 + 0.2 * j};
            small.box(at, at + Vec3d{0.05, 0.02 + 0.02 * ((i + j) % 5), 0.05},
                      (i + j) % 2 ? white(small) : red(small), false);
        }

    SceneMaker gaps = lit();
    gaps.box({-0.8, -0.97, -0.6}, {-0.1, -0.7, 0.1}, white(gaps), false);
    for (int i = 0; i < 6; ++i)
        gaps.quad({0.1 + 0.12 * i, -1, -0.5}, {0, 0, 0.8}, {0, 0.5, 0},
                  i % 2 ? white(gaps) : red(gaps));
    // Light descended from caustics, too.
    SceneMaker caustics = lit();
    caustics.sphere({0.3, -0.5, 0.2}, 0.4, caustics.material(glass()));
    caustics.box({-0.7, -1, -0.3}, {-0.2, -0.5, 0.2}, white(caustics), false);
    // All light is descended, and every surface has a second lobe.
    SceneMaker bulb;
    MaterialDescription both;
    both.diffuse = Rgb(0.3f);
    both.glossy = Rgb(0.4f);
    both.glossyExponent = 20;
    bulb.box({-1, -1, -1}, {1, 1, 1}, bulb.material(both), true);
    bulb.sphere({0, 0.3, 0}, 0.1, bulb.diffuse({}, Rgb(50.0f)));
    bulb.sphere({0, 0.3, 0}, 0.3, bulb.material(glass()));
    bulb.camera({0, 0, 0.95}, {0, 0, 0}, {0, 1, 0}, 80);
    return {{"corners", corners}, {"curved", curved},     {"small things", small},
            {"gaps", gaps},       {"caustics", caustics}, {"glossy bulb", bulb}};
}

// A wall without thickness between light and dark, from above: points beyond it are near, and few
// see it.
Room thinWall() {
    SceneMaker maker;
    const std::int32_t white = maker.diffuse({0.7f, 0.7f, 0.7f});
    maker.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, white);
    maker.quad({0, 0, 1}, {0, 0, -2}, {0, 0.6, 0}, white);
    for (const double x : {-1.0, 1.0}) maker.quad({x, 0, 1}, {0, 0, -2}, {0, 1, 0}, white);
    for (const double z : {-1.0, 1.0}) maker.quad({-1, 0, z}, {2, 0, 0}, {0, 1, 0}, white);
    maker.quad({-0.5, 0.1, 0.2}, {0, 0, -0.4}, {0, 0.4, 0}, maker.diffuse({}, Rgb(20.0f)));
    maker.camera({0, 4, 0.001}, {0, 0, 0}, {0, 0, -1}, 30);
    return {"thin wall", maker};
}

// The indirect layer, its estimated bias taken off: all that is compared here, in kIndirect.
RegionMeans corrected(RegionMeans means) {
    for (LayerMeans& m : means)
        for (std::size_t c = 0; c < 3; ++c) m[kIndirect][c] += m[kCorrected][c] - m[kBeauty][c];
    return means;
}

class GatherPointRooms : public ::testing::TestWithParam<Room> {};

INSTANTIATE_TEST_SUITE_P(Tight, GatherPointRooms, ::testing::ValuesIn(tightRooms()), roomName);

// What the points bring, against own rays by the same maps and camera samples, in one pass.
struct Pairs {
    std::vector<RegionMeans> byPoints, byRays;
};
Pairs renderPairs(const Room& room, std::uint32_t pass, int renders) {
    const auto scene = room.maker.build();
    const std::vector<Rect> regions = squares(kSize, kSize, kRegion);
    constexpr std::uint32_t kSamples = 4;
    Pairs pairs;
    RegionMeans meanByRays(regions.size());
    for (int i = 0; i < renders; ++i) {
        RenderSettings settings = smallFrame(kSize, kSize, IntegratorKind::kPhoton, 1, 3);
        settings.photons = 20'000;
        settings.seed = static_cast<std::uint64_t>(i) + 1;
        PlannedRender render(scene, settings, makePlan(*scene, settings));
        render.begin(pass);
        PhotonMaps maps = render.photons().maps();
        EXPECT_NE(maps.points, nullptr);
        pairs.byPoints.push_back(corrected(render.means(regions, kSamples, maps)));
        maps.points = nullptr;
        pairs.byRays.push_back(corrected(render.means(regions, kSamples, maps)));
        addTo(meanByRays, pairs.byRays.back(), 1.0 / renders);
    }
    // What the maps have in common is no noise of the difference.
    for (std::size_t i = 0; i < pairs.byRays.size(); ++i) {
        addTo(pairs.byPoints[i], pairs.byRays[i], -1);
        addTo(pairs.byPoints[i], meanByRays, 1);
        pairs.byRays[i] = meanByRays;
    }
    return pairs;
}

// By regions and of all. The mean over a radius is off where irradiance slopes up to an edge of
// its surface, most in the first pass; that bias is gone in a later one.
TEST_P(GatherPointRooms, BringWhatOwnRaysBring) {
    for (const std::uint32_t pass : {0u, 15u}) {
        // Where bias is allowed for, that is more than the noise of few renders.
        const Pairs pairs = renderPairs(GetParam(), pass, pass == 0 ? 6 : 16);
        const std::string what = fmt::format("{}, pass {}", GetParam().name, pass);
        expectAgreement(pairs.byPoints, pairs.byRays, kIndirect, pass == 0 ? 0.03 : 0.01, 4, what);
        expectAgreement(wholeFrames(pairs.byPoints), wholeFrames(pairs.byRays), kIndirect,
                        pass == 0 ? 0.01 : 0.001, 4, what);
        // A test that sees nothing proves nothing.
        const Replicated whole = spread(wholeFrames(pairs.byPoints), 0, kIndirect, 1);
        // Bulbs of weak gloss are noisier: what lamps send by way of broad lobes is found by
        // chance.
        EXPECT_LT(whole.standardError, 0.01 * whole.mean);
    }
}

// Without the look for what hides a point, light comes through: |z| is 7 then.
TEST(GatherPoints, AreNotReadThroughThinWalls) {
    const Pairs pairs = renderPairs(thinWall(), 0, 40);
    expectAgreement(pairs.byPoints, pairs.byRays, kIndirect, 0.03, 4, "thin wall");
}

// Pixels of a frame that was begun, by some order of rectangles.
std::vector<float> renderInOrder(const std::shared_ptr<const Scene>& scene,
                                 const std::vector<Rect>& order, const Rect& wanted) {
    FrameRenderer renderer(scene, smallFrame(kSize, kSize, IntegratorKind::kPhoton, 4, 3));
    renderer.beginPass(1, kNotCancelled, {});
    const auto channels = static_cast<std::size_t>(renderer.layout().count);
    std::vector<float> result(static_cast<std::size_t>(wanted.area()) * channels);
    for (const Rect& rect : order) {
        std::vector<float> pixels(static_cast<std::size_t>(rect.area()) * channels);
        std::vector<float> weights(static_cast<std::size_t>(rect.area()));
        renderer.renderRegion(rect, pixels, weights, kNotCancelled);
        for (std::int32_t y = std::max(rect.y0, wanted.y0); y < std::min(rect.y1, wanted.y1); ++y)
            for (std::int32_t x = std::max(rect.x0, wanted.x0); x < std::min(rect.x1, wanted.x1);
                 ++x) {
                const auto from =
                    static_cast<std::size_t>((y - rect.y0) * rect.width() + x - rect.x0) * channels;
                const auto to =
                    static_cast<std::size_t>((y - wanted.y0) * wanted.width() + x - wanted.x0) *
                    channels;
                std::copy_n(pixels.begin() + static_cast<std::ptrdiff_t>(from), channels,
                            result.begin() + static_cast<std::ptrdiff_t>(to));
            }
    }
    return result;
}

// Points are filled when they are first asked for; who asks first must not matter.
TEST(GatherPoints, TheSameBitsInAnyOrder) {
    for (const Room& room : {tightRooms()[0], tightRooms()[4]}) {
        const auto scene = room.maker.build();
        const Rect crop{10, 14, 34, 31};
        const auto alone = renderInOrder(scene, {crop}, crop);
        auto tiles = squares(kSize, kSize, 8);
        EXPECT_EQ(alone, renderInOrder(scene, tiles, crop));
        std::ranges::reverse(tiles);
        EXPECT_EQ(alone, renderInOrder(scene, tiles, crop));
        // Rectangles of one pixel, and an overscan before all.
        tiles = squares(kSize, kSize, 1);
        std::rotate(tiles.begin(), tiles.begin() + 1000, tiles.end());
        tiles.insert(tiles.begin(), {-9, -9, kSize + 9, kSize + 9});
        EXPECT_EQ(alone, renderInOrder(scene, tiles, crop));
    }
}

}  // namespace
}  // namespace pm::test
