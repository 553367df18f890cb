// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Light kept in one place serves no place from which a surface hides it: closed rooms on a lit
// floor are black to the bit, and rooms whose walls meet, lean, end or bend are as path tracing has
// them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "integrator/photons/estimate/irradiance_sites.h"
#include "integrator/photons/trace/photon_tracer.h"
#include "tests/support/replicates.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

constexpr std::int32_t kWidth = 32, kHeight = 24;

// A floor of 12 x 12 and two lamps beside the room in its middle.
SceneMaker litFloor() {
    SceneMaker maker;
    maker.quad({-6, 0, 6}, {12, 0, 0}, {0, 0, -12}, maker.diffuse(Rgb(0.8f)));
    const auto lamp = maker.diffuse({}, Rgb(100.0f));
    maker.quad({2.5, 1.5, -1}, {0, 0, 2}, {0, 1, 0}, lamp);
    maker.quad({2, 3, -1}, {1.5, 0, 0}, {0, 0, 2}, lamp);
    maker.camera({-0.3, 0.54, 0}, {1, 0.12, 0}, {0, 1, 0}, 70);
    return maker;
}

// Sheets from a square on the floor to one of the ceiling, turned about the middle; half sides.
void tent(SceneMaker& maker, double atFloor, double atCeiling, double below, double turn) {
    const auto white = maker.diffuse(Rgb(0.8f));
    const double slope = (atCeiling - atFloor) / 1.2;
    const auto corner = [&](int i, double y) {
        const double half = atFloor + slope * y;
        const double x = (i == 0 || i == 3 ? -1 : 1) * half, z = (i < 2 ? -1 : 1) * half;
        return Vec3d{std::cos(turn) * x + std::sin(turn) * z, y,
                     -std::sin(turn) * x + std::cos(turn) * z};
    };
    for (int i = 0; i < 4; ++i)
        maker.polygon({corner(i, -below), corner((i + 1) % 4, -below), corner((i + 1) % 4, 1.2),
                       corner(i, 1.2)},
                      white);
    maker.polygon({corner(0, 1.2), corner(1, 1.2), corner(2, 1.2), corner(3, 1.2)}, white);
}

// Inner and outer sides of walls of this thickness, sunk into the floor by `below`.
void walls(SceneMaker& maker, double thickness, double below) {
    const auto white = maker.diffuse(Rgb(0.8f));
    const double t = thickness;
    maker.box({-1, -below, -1}, {1, 1.2, 1}, white, true);
    maker.box({-1 - t, -below - t, -1 - t}, {1 + t, 1.2 + t, 1 + t}, white, false);
}

std::vector<Room> closedRooms() {
    std::vector<Room> rooms;
    const auto add = [&](const std::string& name, const auto& build) {
        rooms.push_back({name, litFloor()});
        build(rooms.back().maker);
    };
    add("Sheets", [](SceneMaker& m) { tent(m, 1, 1, 0, 0); });
    add("TurnedSheets", [](SceneMaker& m) { tent(m, 1, 1, 0, 0.5); });
    add("LeaningIn", [](SceneMaker& m) { tent(m, 1, 0.5, 0, 0); });
    add("LeaningOut", [](SceneMaker& m) { tent(m, 1, 1.6, 0, 0.2); });
    add("SunkenSheets", [](SceneMaker& m) { tent(m, 1, 1, 0.15, 0.1); });
    add("ThinWalls", [](SceneMaker& m) { walls(m, 0.01, 0.02); });
    add("WallsOfACell", [](SceneMaker& m) { walls(m, 0.1, 0.05); });
    return rooms;
}

class ClosedRooms : public ::testing::TestWithParam<Room> {};

TEST_P(ClosedRooms, AreBlackToTheBit) {
    const auto scene = GetParam().maker.build();
    for (const std::uint64_t seed : {1, 2, 3}) {
        RenderSettings settings = smallFrame(kWidth, kHeight, IntegratorKind::kPhoton, 2, 3);
        settings.seed = seed;
        const MeasuredLayers layers = measure(scene, settings);
        for (const double channel : layers.beauty.mean)
            EXPECT_EQ(channel, 0.0) << "seed " << seed << ", direct " << layers.direct.mean[0]
                                    << ", indirect " << layers.indirect.mean[0];
        EXPECT_GT(layers.counters.photonsStoredGlobal, 10'000u);
    }
}

TEST_P(ClosedRooms, LetNoPhotonIn) {
    const auto scene = GetParam().maker.build();
    const LightSampler lights(*scene);
    const auto photons = tracePhotons(*scene, lights, {PhotonKind::kGlobal, 1'000'000, 1, 0},
                                      std::atomic<bool>{false}, {})
                             .photons;
    int inside = 0;
    for (const Photon& photon : photons) {
        const Vec3f p = Vec3f(Vec3d(photon.position) + scene->centre());
        // On a wall's side that faces the middle.
        const Vec3f n = photon.normal.unpack();
        inside += p.y > 0.01f && p.y < 1.19f && std::max(std::abs(p.x), std::abs(p.z)) < 0.9f &&
                  p.x * n.x + p.z * n.z < 0.0f;
    }
    EXPECT_EQ(inside, 0) << " of " << photons.size();
}

INSTANTIATE_TEST_SUITE_P(Leaks, ClosedRooms, ::testing::ValuesIn(closedRooms()), roomName);

// A sheet across a room, with the lamp on one side of it.
TEST(Leaks, ASheetDividesARoom) {
    SceneMaker maker;
    const auto white = maker.diffuse(Rgb(0.8f));
    maker.box({-1, 0, -1}, {1, 1.2, 1}, white, true);
    maker.quad({0.2, -0.1, -1.1}, {0, 0, 2.2}, {0, 1.4, 0}, white);
    maker.quad({0.5, 1.19, -0.3}, {0.3, 0, 0}, {0, 0, 0.6}, maker.diffuse({}, Rgb(100.0f)));
    maker.camera({-0.6, 0.6, 0}, {0.2, 0.1, 0}, {0, 1, 0}, 70);
    const MeasuredLayers layers =
        measure(maker.build(), smallFrame(kWidth, kHeight, IntegratorKind::kPhoton, 4, 3));
    for (const double channel : layers.beauty.mean) EXPECT_EQ(channel, 0.0);
}

// A closed room of six walls, lit from above alone, in a ring of glass balls whose caustics lie at
// its feet.
SceneMaker roomInARing(int balls) {
    constexpr double kTurn = 2 * std::numbers::pi, kRoom = 0.5;
    SceneMaker maker;
    const auto white = maker.diffuse(Rgb(0.7f));
    maker.quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, white);
    maker.quad({-0.4, 3, -0.4}, {0.8, 0, 0}, {0, 0, 0.8}, maker.diffuse({}, Rgb(30.0f)));
    std::vector<Vec3d> roof;
    for (int i = 0; i < 6; ++i) {
        const auto at = [&](int k, double y) {
            return Vec3d{kRoom * std::cos(kTurn * k / 6), y, kRoom * std::sin(kTurn * k / 6)};
        };
        maker.polygon({at(i, 0), at(i + 1, 0), at(i + 1, 0.8), at(i, 0.8)}, white);
        roof.push_back(at(i, 0.8));
    }
    maker.polygon(roof, white);
    const auto clear = maker.material(glass());
    const double radius = std::min(0.15, 2.0 / balls);
    for (int i = 0; i < balls; ++i) {
        const double angle = kTurn * (i + 0.5) / balls, away = kRoom + 1.15 * radius;
        maker.meshSphere({away * std::cos(angle), 1.3 * radius, away * std::sin(angle)}, radius,
                         clear, false, 8);
    }
    maker.camera({0, 0.5, 0.35}, {0, 0.1, -0.2}, {0, 1, 0}, 80);
    return maker;
}

TEST(Leaks, ARingOfGlassBallsShinesIntoNoRoom) {
    const auto expectDark = [](const SceneMaker& maker, IntegratorKind integrator, double most) {
        const MeasuredLayers layers =
            measure(maker.build(), smallFrame(kWidth, kHeight, integrator, 4, 3));
        for (const double channel : layers.beauty.mean) EXPECT_LE(channel, most);
    };
    for (const int balls : {6, 12, 24}) {
        SCOPED_TRACE(balls);
        expectDark(roomInARing(balls), IntegratorKind::kPhoton, 2e-5);
    }
    // Where coordinates are coarse, too.
    SceneMaker far = roomInARing(6);
    far.polygon({{3e4, 0, 0}, {3e4, 0, 1}, {3e4, 1, 0}}, far.diffuse(Rgb(0.7f)));
    expectDark(far, IntegratorKind::kPhoton, 2e-5);
    expectDark(far, IntegratorKind::kPath, 0.0);
}

SceneMaker litRoom() {
    SceneMaker maker;
    maker.box({-2, 0, -2}, {2, 2, 2}, maker.diffuse(Rgb(0.8f)), true);
    maker.quad({0.6, 1.99, -0.3}, {0.6, 0, 0}, {0, 0, 0.6}, maker.diffuse({}, Rgb(50.0f)));
    return maker;
}

std::vector<Room> openRooms() {
    std::vector<Room> rooms;
    const auto add = [&](const std::string& name, const auto& build) {
        rooms.push_back({name, litRoom()});
        build(rooms.back().maker, rooms.back().maker.diffuse(Rgb(0.8f)));
    };
    add("AcuteWedge", [](SceneMaker& m, std::uint32_t white) {
        m.quad({0, 0, -1.5}, {0, 0, 3}, {-1.9, 0.7, 0}, white);
        m.camera({-0.8, 0.16, 1.2}, {-0.5, 0.05, -1}, {0, 1, 0}, 50);
    });
    add("BoxOnATable", [](SceneMaker& m, std::uint32_t white) {
        m.box({-1, 0.6, -1}, {1, 0.65, 1}, white, false);
        m.box({-0.4, 0.65, -0.3}, {0.1, 0.95, 0.3}, white, false);
        m.camera({0.9, 1.2, 1.2}, {-0.1, 0.65, 0}, {0, 1, 0}, 50);
    });
    add("CupboardAjar", [](SceneMaker& m, std::uint32_t white) {
        m.box({-0.5, 0, -0.5}, {0.5, 1, -0.48}, white, false);
        m.box({-0.5, 0, -0.5}, {-0.48, 1, 0.3}, white, false);
        m.box({0.48, 0, -0.5}, {0.5, 1, 0.3}, white, false);
        m.box({-0.5, 0.98, -0.5}, {0.5, 1, 0.3}, white, false);
        m.quad({-0.5, 0, 0.3}, {0.98, 0, 0.18}, {0, 1, 0}, white);
        m.camera({0.1, 0.5, 0.1}, {-0.3, 0.1, 0.25}, {0, 1, 0}, 60);
    });
    add("BallsOnTheFloor", [](SceneMaker& m, std::uint32_t white) {
        m.sphere({-0.4, 0.3, 0}, 0.3, white);
        m.meshSphere({0.4, 0.12, 0.3}, 0.12, white, false, 8);
        m.camera({0.3, 0.8, 1.4}, {0, 0.1, 0}, {0, 1, 0}, 50);
    });
    add("BesideAPane", [](SceneMaker& m, std::uint32_t) {
        m.box({-0.01, 0.0005, -0.8}, {0.01, 1, 0.8}, m.material(glass()), false);
        m.camera({0.6, 0.6, 1.2}, {0, 0.05, 0}, {0, 1, 0}, 50);
    });
    return rooms;
}

class OpenRooms : public ::testing::TestWithParam<Room> {};

// Off by at most 5 % of the square's light, half a percent of the frame's, and what chance may do.
TEST_P(OpenRooms, AreAsPathTracingHasThem) {
    const auto scene = GetParam().maker.build();
    std::vector<Rect> regions = squares(kWidth, kHeight, 8);
    const auto renders = [&](IntegratorKind integrator, int count, std::uint32_t level) {
        RenderSettings settings = smallFrame(kWidth, kHeight, integrator, 4, level);
        return replicate(count, [&](std::uint64_t seed) {
            settings.seed = seed;
            return render(scene, settings, regions);
        });
    };
    const auto photon = renders(IntegratorKind::kPhoton, 6, 3);
    const auto path = renders(IntegratorKind::kPath, 6, 4);
    double frame = 0, worst = 0;
    for (std::size_t i = 0; i < regions.size(); ++i)
        frame += spread(path, i, kBeauty, 1).mean / static_cast<double>(regions.size());
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const Replicated a = spread(photon, i, kBeauty, 1), b = spread(path, i, kBeauty, 1);
        // Student's t of five degrees of freedom goes beyond 6 as often as a normal one beyond 3.
        const double allowed = 0.05 * b.mean + 0.005 * frame;
        const double error = std::hypot(a.standardError, b.standardError);
        const double off = std::abs(a.mean - b.mean);
        worst = std::max(worst, (off - allowed) / std::max(error, 1e-12));
        EXPECT_LE(off, allowed + 6 * error)
            << "region " << i << ": photon " << a.mean << " +- " << a.standardError << ", path "
            << b.mean << " +- " << b.standardError;
    }
    fmt::print("    worst region {:.2f} standard errors beyond what is allowed\n", worst);
}

INSTANTIATE_TEST_SUITE_P(Leaks, OpenRooms, ::testing::ValuesIn(openRooms()), roomName);

// What stands on the far side of a sheet has bright sites in the same cells: none of them serves.
TEST(Leaks, NoSiteServesBeyondASheet) {
    SceneMaker maker;
    const auto grey = maker.diffuse(Rgb(0.5f));
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, grey);
    maker.quad({0.013, -1, 0}, {0, 2, 0}, {0, 0, 1}, grey);
    const auto scene = maker.build();
    const Vec3f centre(scene->centre());
    std::vector<Photon> photons;
    for (int j = 0; j < 200; ++j)
        for (int i = 0; i < 100; ++i)
            photons.push_back({Vec3f(0.013f + 0.00987f * (static_cast<float>(i) + 0.5f),
                                     -1 + 0.01f * (static_cast<float>(j) + 0.5f), 0) -
                                   centre,
                               Rgb(1e-4f), PackedNormal({0, 0, 1})});
    const PhotonMap map(photons);
    const IrradianceSites sites(*scene, map, 0.15f);
    const float expected = 1e-4f / (0.00987f * 0.01f);
    float bright = 0;
    int count = 0;
    for (float x = -0.3f; x < 0.3f; x += 0.0037f)
        for (float y = -0.5f; y < 0.5f; y += 0.05f) {
            const TwoRadii found = sites.at(Vec3f(x, y, 0) - centre, {0, 0, 1});
            if (x < 0.012f) {
                EXPECT_EQ(found.wide.r, 0.0f) << x << " " << y;
            } else if (x > 0.014f) {
                bright += found.wide.r;
                ++count;
            }
        }
    EXPECT_NEAR(bright / static_cast<float>(count), expected, 0.03f * expected);
}

}  // namespace
}  // namespace pm::test
