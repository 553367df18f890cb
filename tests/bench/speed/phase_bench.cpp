// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <thread>
#include <utility>

#include "integrator/sampling/sampler.h"
#include "tests/bench/run/bench_scenes.h"
#include "tests/bench/run/render_run.h"
#include "tests/bench/speed/speed_bench.h"

namespace pm::bench {

namespace {

// Seconds of each phase, one entry a turn.
struct Phases {
    std::vector<double> build, photons, maps, render, whole, processorNsPerSample;

    void add(const test::SceneMaker& maker, IntegratorKind kind, int threads) {
        tbb::task_arena arena(threads);
        std::shared_ptr<const Scene> scene;
        build.push_back(secondsOf([&] { arena.execute([&] { scene = maker.build(); }); }));
        Accumulated last;
        const RenderCounters counters =
            renderPasses(scene, test::smallFrame(256, 256, kind, 4, 3), threads,
                         [&](const Accumulated& so) { last = so; });
        photons.push_back(counters.photonSeconds);
        maps.push_back(counters.mapSeconds);
        render.push_back(last.renderSeconds);
        whole.push_back(build.back() + last.wallSeconds);
        processorNsPerSample.push_back(1e9 * last.processorSeconds /
                                       static_cast<double>(counters.cameraSamples));
    }
};

// Each thread steps a number through a chain that nothing can shorten, in registers alone.
void calculate(int threads) {
    std::vector<std::jthread> all;
    for (int i = 0; i < threads; ++i)
        all.emplace_back([] {
            double x = 0.5;
            for (int step = 0; step < 100'000'000; ++step) x = x * 3.7 * (1 - x);
            benchmark::DoNotOptimize(x);
        });
}

struct Case {
    std::string name;
    test::SceneMaker maker;
    IntegratorKind kind;
    int threads;
    Phases phases{};
    Phases aside[2]{};  // of a case with one thread: two such renders at the same time

    void measure() { phases.add(maker, kind, threads); }
};

// What the machine gains where nothing is shared but itself: caches, memory and its host.
void renderSideBySide(Case& c) {
    std::vector<std::jthread> both;
    for (Phases& phases : c.aside)
        both.emplace_back([&] { phases.add(c.maker, c.kind, c.threads); });
}

// calculations: seconds of calculate() with one thread and with two, by turns. cases: each with one
// thread is followed by the same with two.
void tellGains(Report& report, const std::vector<std::vector<double>>& calculations,
               const std::vector<Case>& cases) {
    report.table(
        "Two threads over one, of each phase; what the machine itself gains beside it and first",
        {"work", "two threads", "two renders of one thread at the same time"});
    // Two have twice the work.
    const auto doubled = [](std::vector<double> seconds) {
        for (double& s : seconds) s *= 2;
        return seconds;
    };
    report.row({"arithmetic in registers, nothing shared", "",
                show(speedRatio(calculations[1], doubled(calculations[0])))});
    for (std::size_t i = 0; i + 1 < cases.size(); i += 2) {
        const Case &single = cases[i], &both = cases[i + 1];
        const auto row = [&](const char* phase, std::vector<double> Phases::*seconds) {
            std::vector<double> aside = single.aside[0].*seconds;
            for (std::size_t turn = 0; turn < aside.size(); ++turn)
                aside[turn] = (aside[turn] + (single.aside[1].*seconds)[turn]) / 2;
            const std::vector<double>& alone = single.phases.*seconds;
            report.row({fmt::format("{}: {}", single.name, phase),
                        show(speedRatio(both.phases.*seconds, alone)),
                        show(speedRatio(aside, doubled(alone)))});
        };
        if (single.kind == IntegratorKind::kPhoton) {
            row("photons", &Phases::photons);
            row("maps", &Phases::maps);
        }
        row("render", &Phases::render);
    }
}

}  // namespace

void benchPhases(Report& report, int turns) {
    report.table("Seconds of each phase, 256 x 256 pixels, 4 passes of 4 samples",
                 {"scene, integrator, threads", "scene build", "photons", "maps", "render", "whole",
                  "ns of processor time a camera sample, photons and maps included"});
    std::vector<Case> cases;
    for (const auto& [scene, maker] : {std::pair{"box of 32 triangles", plainBox()},
                                       std::pair{"the same with 2 spheres", boxWithSpheres()}})
        for (const auto& [name, kind] : {std::pair{"photon", IntegratorKind::kPhoton},
                                         std::pair{"path", IntegratorKind::kPath}})
            for (const int threads : {1, 2})
                cases.push_back({fmt::format("{}, {}, {}", scene, name, threads),
                                 maker,
                                 kind,
                                 threads,
                                 {},
                                 {}});
    std::vector<std::vector<double>> calculations(2);
    for (int turn = 0; turn < turns; ++turn) {
        for (std::size_t i = 0; i + 1 < cases.size(); i += 2) {
            Case &single = cases[i], &both = cases[i + 1];
            single.measure();
            // Two busy processors may be slower for a while after: each comes first as often.
            if (turn % 2 == 0) both.measure();
            renderSideBySide(single);
            if (turn % 2 == 1) both.measure();
        }
        for (const int threads : {1, 2})
            calculations[static_cast<std::size_t>(threads - 1)].push_back(
                secondsOf([&] { calculate(threads); }));
    }
    for (const Case& c : cases) {
        const Phases& p = c.phases;
        report.row({c.name, show(spreadOf(p.build)), show(spreadOf(p.photons)),
                    show(spreadOf(p.maps)), show(spreadOf(p.render)), show(spreadOf(p.whole)),
                    show(spreadOf(p.processorNsPerSample))});
    }
    tellGains(report, calculations, cases);
}

void benchSampler(Report& report, int turns) {
    report.table("Random numbers, nanoseconds, one thread; 8 drawn from each sampler",
                 {"what", "ns"});
    constexpr int kSamples = 200'000, kDraws = 8;
    const auto drawing = [](int draws, const auto& draw) {
        return [draws, draw] {
            for (int i = 0; i < kSamples; ++i) {
                Sampler sampler(1, 0, static_cast<std::uint64_t>(i / 16),
                                static_cast<std::uint32_t>(i % 16));
                benchmark::DoNotOptimize(sampler);
                for (int d = 0; d < draws; ++d) draw(sampler);
            }
        };
    };
    const auto pair = [](Sampler& s) {
        benchmark::DoNotOptimize(s.get2D(Purpose::kDirection));
        s.nextEvent();
    };
    const auto single = [](Sampler& s) {
        benchmark::DoNotOptimize(s.get1D(Purpose::kLobe));
        s.nextEvent();
    };
    const auto times =
        takeTurns(turns, {drawing(0, pair), drawing(kDraws, pair), drawing(kDraws, single)});
    report.row({"a sampler made", show(spreadOf(times[0]), 1e9 / kSamples)});
    for (const auto& [name, i] :
         {std::pair{"a pair drawn", 1u}, std::pair{"a single number drawn", 2u}}) {
        std::vector<double> draws;
        for (std::size_t turn = 0; turn < times[0].size(); ++turn)
            draws.push_back(times[i][turn] - times[0][turn]);
        report.row({name, show(spreadOf(draws), 1e9 / (kSamples * kDraws))});
    }
}

}  // namespace pm::bench
