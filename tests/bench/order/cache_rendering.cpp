// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/order/cache_rendering.h"

#include <chrono>
#include <numeric>
#include <thread>
#include <utility>

#include "plugin/session/bucket_needs.h"
#include "scheduler/buckets/bucket_order.h"

namespace pm::bench {

namespace {

constexpr std::int32_t kBucketPixels = 16;
constexpr std::uint64_t kAll = std::uint64_t{1} << 40;
// Less than maps take.
constexpr std::uint64_t kShortOfMaps = std::uint64_t{32} << 20;

// The paper's network: whoever misses waits.
class PauseWatch : public CacheWatch {
  public:
    explicit PauseWatch(std::uint32_t microseconds) : m_microseconds(microseconds) {}
    void asked(const CacheAsked& what) override {
        if (what.missed && m_microseconds > 0)
            std::this_thread::sleep_for(std::chrono::microseconds(m_microseconds));
    }

  private:
    std::uint32_t m_microseconds;
};

}  // namespace

CacheRendering::CacheRendering(CacheScene scene)
    : m_scene(std::move(scene)),
      m_grid(m_scene.settings.window, kBucketPixels),
      m_order(m_scene.name, m_scene.scene, m_scene.settings, m_scene.photons.get()) {}

void CacheRendering::observe() {
    const BucketTimes plain = m_order.render(settingOf({.budget = kAll}, kShortOfMaps));
    m_seconds.assign(m_grid.cellCount(), 0.0);
    for (std::size_t i = 0; i < plain.cells.size(); ++i)
        m_seconds[plain.cells[i]] =
            std::accumulate(plain.atoms[i].begin(), plain.atoms[i].end(), 0.0);
    m_trace = traceOf(kShortOfMaps);
    if (m_scene.photons) m_roomyTrace = traceOf(kAll);
}

CacheTrace CacheRendering::traceOf(std::uint64_t budgetOfMaps) {
    TraceWatch watch(m_grid.cellCount(), m_scene.untraced);
    BucketSetting setting = settingOf({.budget = kAll}, budgetOfMaps);
    setting.around = [&](std::uint32_t cell, const std::function<void()>& render) {
        const CacheWatch::Scope scope(&watch);
        watch.begin(cell);
        render();
    };
    m_order.render(setting);
    return watch.take();
}

std::uint64_t CacheRendering::missesOfPhotons(std::uint64_t budget) {
    BucketSetting setting{"hilbert", kBucketPixels, 1, {}, {}, {}, {}};
    std::uint64_t before = 0, misses = 0;
    setting.begun = [&] {
        m_scene.empty();
        m_scene.setBudget(budget);
        before = m_scene.misses();
    };
    setting.prepared = [&] {
        misses = m_scene.misses() - before;
        m_scene.setBudget(kAll);
    };
    m_order.render(setting);
    return misses;
}

CacheRun CacheRendering::run(const CacheRequest& request) {
    BucketSetting setting = settingOf(request, request.budget);
    std::uint64_t before = 0;
    setting.prepared = [&, inner = setting.prepared] {
        inner();
        before = m_scene.misses();
    };
    std::unique_ptr<plugin::BucketNeeds> needs;
    if (request.order == "correlated" && m_scene.groups) {
        needs = std::make_unique<plugin::BucketNeeds>(m_grid, *m_scene.groups);
        setting.missing = [&](std::uint32_t cell) { return needs->missing(cell); };
    }
    setting.around = [&](std::uint32_t cell, const std::function<void()>& render) {
        PauseWatch pause(request.pause);
        const CacheWatch::Scope scope(&pause);
        const plugin::BucketNeeds::Noting noting(needs.get(), cell);
        render();
    };
    const BucketTimes times = m_order.render(setting);
    return {times.seconds, m_scene.misses() - before, times.cells};
}

std::vector<std::uint32_t> CacheRendering::cellsOf(const std::string& order, std::uint64_t seed) {
    if (order != "correlated")
        return findBucketOrder(order)->cells(m_grid.columns(), m_grid.rows(), seed);
    if (m_correlated.empty()) m_correlated = run({.order = order, .budget = budgetOf(8)}).cells;
    return m_correlated;
}

// budgetOfMaps: of pages while maps are made.
BucketSetting CacheRendering::settingOf(const CacheRequest& request, std::uint64_t budgetOfMaps) {
    BucketSetting setting{request.order, kBucketPixels, request.threads, {}, {}, {}, {}};
    setting.begun = [this, budget = m_scene.photons ? budgetOfMaps : kAll] {
        m_scene.setBudget(budget);
    };
    setting.prepared = [this, budget = request.budget] {
        m_scene.empty();
        m_scene.setBudget(budget);
    };
    return setting;
}

}  // namespace pm::bench
