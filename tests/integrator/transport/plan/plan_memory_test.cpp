// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What the maps of unlike scenes take, against what was planned.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/support/rooms.h"

namespace pm::test {
namespace {

struct Case {
    std::string name;
    SceneMaker maker;
    RenderSettings settings;
};

SceneMaker furnace(float reflectance) {
    SceneMaker maker;
    maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(reflectance), Rgb(1.0f)), true);
    maker.camera({0, 0, 0.9}, {0.1, 0.2, 0}, {0, 1, 0}, 60);
    return maker;
}

SceneMaker litRoom(double lamp) {
    SceneMaker maker = openRoom();
    maker.camera({0, 0, 3.9}, {0, 0, 0}, {0, 1, 0}, 37);
    ceilingLamp(maker, lamp, Rgb(10.0f));
    return maker;
}

SceneMaker outdoors() {
    SceneMaker maker;
    maker.quad({-50, 0, 50}, {100, 0, 0}, {0, 0, -100}, maker.diffuse(Rgb(0.4f)));
    maker.box({-1, 0, -1}, {1, 2, 1}, maker.diffuse(Rgb(0.7f)), false);
    maker.meshSphere({2, 0.8, 0}, 0.8, maker.diffuse(Rgb(0.6f)), false, 48);
    maker.sky(Rgb(1.0f));
    maker.sun({-1, -2, -1}, Rgb(3.0f), 0.005);
    maker.camera({0, 2, 8}, {0, 1, 0}, {0, 1, 0}, 40);
    return maker;
}

std::vector<Case> cases() {
    std::vector<Case> cases;
    const auto add = [&](const std::string& name, const SceneMaker& maker, std::int32_t size,
                         std::uint64_t photons, std::uint32_t passes) {
        RenderSettings settings = smallFrame(size, size, IntegratorKind::kPhoton, passes, 1);
        settings.photons = photons;
        cases.push_back({name, maker, settings});
    };
    add("dark furnace", furnace(0.2f), 64, 60'000, 1);
    add("furnace", furnace(0.8f), 64, 60'000, 2);
    add("bright furnace", furnace(0.999f), 32, 4'000, 1);
    add("room", litRoom(0.3), 128, 200'000, 2);
    add("small frame", litRoom(0.3), 24, 100, 1);
    add("outdoors", outdoors(), 96, 100'000, 2);
    SceneMaker balls = litRoom(0.2);
    balls.sphere({-0.4, -0.6, 0}, 0.4, balls.material(glass()));
    balls.sphere({0.5, -0.7, 0.2}, 0.3, balls.material(mirror()));
    add("balls", balls, 96, 100'000, 2);
    SceneMaker bulb = openRoom();
    bulb.camera({0, 0, 3.9}, {0, 0, 0}, {0, 1, 0}, 37);
    bulb.sphere({0, 0.2, 0}, 0.4, bulb.material(glass()));
    bulb.sphere({0, 0.2, 0}, 0.1, bulb.diffuse({}, Rgb(50.0f)));
    add("lamp in glass", bulb, 64, 50'000, 1);
    SceneMaker pane = litRoom(0.2);
    pane.box({-0.9, -0.5, -0.9}, {0.9, -0.4, 0.9}, pane.material(glass()), false);
    add("pane", pane, 64, 100'000, 4);
    for (const Room& room : roomsOfEveryLobe()) add(room.name, room.maker, 48, 40'000, 1);
    return cases;
}

// Within a factor of 1.5 either way, with maps that take 4 to 40 MB.
TEST(PlanMemory, IsWhatTheMapsTake) {
    for (const Case& c : cases()) {
        FrameRenderer renderer(c.maker.build(), c.settings);
        const auto planned = static_cast<double>(renderer.plan().mapBytes);
        const auto pixels = static_cast<std::size_t>(c.settings.window.area());
        std::vector<float> values(pixels * static_cast<std::size_t>(renderer.layout().count));
        std::vector<float> weights(pixels);
        const std::atomic<bool> cancelled{false};
        for (std::uint32_t pass = 0; pass < c.settings.passes; ++pass) {
            renderer.beginPass(pass, cancelled, {});
            renderer.renderRegion(c.settings.window, values, weights, cancelled);
        }
        const RenderCounters counters = renderer.counters();
        const auto used = static_cast<double>(counters.peakMapBytes);
        std::printf("    %-28s planned %6.2f MB, used %6.2f MB, %.2f\n", c.name.c_str(),
                    planned * 1e-6, used * 1e-6, planned / used);
        if (renderer.plan().tracePhotons) {
            EXPECT_LT(planned, 1.5 * used) << c.name;
            EXPECT_LT(used, 1.5 * planned) << c.name;
        }
    }
}

}  // namespace
}  // namespace pm::test
