// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <thread>
#include <utility>

#include "integrator/sampling/sampler.h"
#include "tests/bench/bench_scenes.h"
#include "tests/bench/render_run.h"
#include "tests/bench/speed_bench.h"

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
};

// calculations: seconds of calculate() with one thread and with two, by turns. cases: each with one
// thread is followed by the same with two.
void tellGains(Report& report, const std::vector<std::vector<double>>& calculations,
               const std::vector<Case>& cases) {
    report.table("Two threads over one, of each phase; what the machine itself gains stands first",
                 {"work", "ratio of speeds"});
    std::vector<double> one = calculations[0];
    for (double& seconds : one) seconds *= 2;  // two have twice the work
    report.row({"arithmetic in registers, nothing shared", show(speedRatio(calculations[1], one))});
    for (std::size_t i = 0; i + 1 < cases.size(); i += 2) {
        const Phases &single = cases[i].phases, &both = cases[i + 1].phases;
        const auto row = [&](const char* phase, const auto& ours, const auto& theirs) {
            report.row(
                {fmt::format("{}: {}", cases[i].name, phase), show(speedRatio(ours, theirs))});
        };
        if (cases[i].kind == IntegratorKind::kPhoton) {
            row("photons", both.photons, single.photons);
            row("maps", both.maps, single.maps);
        }
        row("render", both.render, single.render);
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
                cases.push_back(
                    {fmt::format("{}, {}, {}", scene, name, threads), maker, kind, threads});
    std::vector<std::vector<double>> calculations(2);
    for (int turn = 0; turn < turns; ++turn) {
        for (Case& c : cases) c.phases.add(c.maker, c.kind, c.threads);
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
    const auto pair = [](Sampler& s) { benchmark::DoNotOptimize(s.next2D()); };
    const auto single = [](Sampler& s) { benchmark::DoNotOptimize(s.next1D()); };
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
