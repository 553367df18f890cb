// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Whether a pass takes the time that the plan tells: on scenes of unlike kinds, the estimate beside
// the processor time of a pass, pilots' share included.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/plan/plan_scenes.h"
#include "tests/bench/run/pass_renderer.h"
#include "tests/bench/run/timing.h"
#include "tests/support/rooms.h"

namespace pm::bench {
namespace {

struct Options {
    std::int32_t size = 128;
    std::uint32_t passes = 4;
    bool quick = false;
};

// A room with rows of balls of so many triangles each.
test::SceneMaker ballRoom(const MaterialDescription& material, int rings) {
    test::SceneMaker maker = test::openRoom();
    test::ceilingLamp(maker, 0.4, Rgb(8.0f));
    const auto index = maker.material(material);
    for (int i = 0; i < 12; ++i)
        for (int j = 0; j < 12; ++j)
            maker.meshSphere({-0.85 + 0.154 * i, -0.9, -0.85 + 0.154 * j}, 0.07, index, false,
                             rings);
    maker.camera({0, 0, 3.9}, {0, -0.2, 0}, {0, 1, 0}, 37);
    return maker;
}

std::vector<test::Room> scenes() {
    std::vector<test::Room> all;
    for (PlanScene& scene : planScenes()) all.push_back({scene.key, std::move(scene.maker)});
    for (test::Room& room : test::roomsOfEveryLobe())
        all.push_back({"room: " + room.name, std::move(room.maker)});
    MaterialDescription grey;
    grey.diffuse = Rgb(0.5f);
    MaterialDescription sheen = grey;
    sheen.glossy = Rgb(0.2f);
    sheen.glossyExponent = 40;
    all.push_back({"balls, 160,000 triangles", ballRoom(grey, 17)});
    all.push_back({"balls, 1.1 million triangles", ballRoom(grey, 44)});
    all.push_back({"balls with a sheen, 160,000", ballRoom(sheen, 17)});
    return all;
}

int run(const Options& options) {
    int within = 0, count = 0;
    fmt::print("{:<30} {:>10} {:>10} {:>7}\n", "scene", "told s", "took s", "ratio");
    for (const test::Room& room : scenes()) {
        const auto scene = room.maker.build();
        RenderSettings settings;
        settings.width = settings.height = options.size;
        settings.window = {0, 0, options.size, options.size};
        settings.passes = options.quick ? 1 : options.passes;
        const Plan plan = makePlan(*scene, settings);
        const double before = processorSeconds();
        PassRenderer renderer(scene, settings, plan, 1);
        for (std::uint32_t pass = 0; pass < settings.passes; ++pass) renderer.next();
        const double took = (processorSeconds() - before) / settings.passes;
        const double ratio = plan.processorSecondsPerPass / took;
        ++count;
        within += ratio >= 0.5 && ratio <= 2;
        fmt::print("{:<30} {:>10.3f} {:>10.3f} {:>7.2f}\n", room.name, plan.processorSecondsPerPass,
                   took, ratio);
    }
    fmt::print("within a factor of 2: {} of {}\n", within, count);
    return 0;
}

}  // namespace
}  // namespace pm::bench

int main(int argc, char** argv) {
    CLI::App app{"the plan's time of a pass beside what it takes"};
    pm::bench::Options options;
    app.add_flag("--quick", options.quick, "one pass each");
    app.add_option("--size", options.size, "pixels of a side, a multiple of 8");
    app.add_option("--passes", options.passes, "of each scene");
    CLI11_PARSE(app, argc, argv);
    return pm::bench::run(options);
}
