// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include "integrator/photons/trace/photon_tracer.h"
#include "tests/bench/run/bench_scenes.h"
#include "tests/bench/speed/speed_bench.h"

namespace pm::bench {

namespace {

const std::atomic<bool> kNotCancelled{false};

PhotonTraceResult trace(const Scene& scene, const LightSampler& lights, PhotonKind kind,
                        std::uint64_t count) {
    return tracePhotons(scene, lights, {kind, count, 1, 0}, kNotCancelled, {});
}

// One row: the work on one thread and on two, taking turns.
void addRow(Report& report, const std::string& name, double amount, int turns,
            const std::function<void()>& work) {
    tbb::task_arena one(1), two(2);
    const auto times = takeTurns(turns, {[&] { one.execute(work); }, [&] { two.execute(work); }});
    report.row({name, show(rate(amount, times[0]), 1e-6), show(rate(amount, times[1]), 1e-6),
                show(speedRatio(times[1], times[0]))});
}

void benchTracing(Report& report, int turns, const Scene& scene, const LightSampler& lights) {
    report.table(
        "Photons traced in the box of 32 triangles and 2 spheres, millions emitted a second",
        {"map", "1 thread", "2 threads", "2 threads / 1"});
    constexpr std::uint64_t kPhotons = 200'000;
    for (const auto& [name, kind] :
         {std::pair{"global", PhotonKind::kGlobal}, std::pair{"caustic", PhotonKind::kCaustic}}) {
        const std::size_t stored = trace(scene, lights, kind, kPhotons).photons.size();
        addRow(report,
               fmt::format("{}, {:.3f} stored of one emitted", name,
                           static_cast<double>(stored) / static_cast<double>(kPhotons)),
               static_cast<double>(kPhotons), turns, [&] {
                   benchmark::DoNotOptimize(trace(scene, lights, kind, kPhotons).photons.data());
               });
    }
}

}  // namespace

void benchPhotons(Report& report, int turns) {
    const auto scene = boxWithSpheres().build();
    const LightSampler lights(*scene);
    benchTracing(report, turns, *scene, lights);

    report.table("Photon map built, millions of photons a second",
                 {"photons", "1 thread", "2 threads", "2 threads / 1"});
    BigVector<Photon> photons = trace(*scene, lights, PhotonKind::kGlobal, 7'500'000).photons;
    for (const std::size_t count : {10'000'000u, 1'000'000u, 200'000u}) {
        if (photons.size() < count) continue;
        // Photons come in the order of their stratified emission; the first ones stand for all.
        photons.resize(count);
        addRow(report, fmt::format("{}", count), static_cast<double>(count),
               count > 5'000'000u ? std::min(turns, 3) : turns, [&] {
                   const PhotonMap map(photons);
                   benchmark::DoNotOptimize(map.size());
               });
    }
}

}  // namespace pm::bench
