// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/order/order_run.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <utility>

#include "scheduler/buckets/bucket_order.h"
#include "scheduler/buckets/bucket_runner.h"
#include "scheduler/buckets/hilbert_order.h"
#include "scheduler/film/correlated_choice.h"
#include "tests/bench/run/timing.h"

namespace pm::bench {

namespace {

const std::atomic<bool> kNeverCancelled{false};

// Pixels and weights of any region, for the renderer to write to.
struct Target {
    std::vector<float> pixels, weights;

    void render(const FrameRenderer& renderer, const Rect& region) {
        const auto area = static_cast<std::size_t>(region.area());
        pixels.resize(area * static_cast<std::size_t>(renderer.layout().count));
        weights.resize(area);
        renderer.renderRegion(region, pixels, weights, kNeverCancelled);
    }
};

// Processor seconds of each atom, by bucket as they are begun.
class AtomTimes {
  public:
    explicit AtomTimes(const BucketGrid& grid)
        : m_places(grid.cellCount()), m_seconds(grid.cellCount()) {}

    // Threads: any, for different buckets.
    void begin(std::uint32_t cell, const Rect& rect) {
        m_places[cell] = m_begun.fetch_add(1);
        m_seconds[m_places[cell]].resize(static_cast<std::size_t>(atomCount(rect)));
    }

    // Threads: any, for different atoms.
    double& at(std::uint32_t cell, const Rect& rect, const Rect& atom) {
        std::int32_t index = 0;
        while (atomOf(rect, index) != atom) ++index;
        return m_seconds[m_places[cell]][static_cast<std::size_t>(index)];
    }

    std::vector<std::vector<double>> take() { return std::move(m_seconds); }
    std::vector<std::uint32_t> cells() const {
        std::vector<std::uint32_t> cells(m_begun.load());
        for (std::size_t cell = 0; cell < m_places.size(); ++cell)
            if (!m_seconds[m_places[cell]].empty())
                cells[m_places[cell]] = static_cast<std::uint32_t>(cell);
        return cells;
    }

  private:
    std::atomic<std::size_t> m_begun{0};
    std::vector<std::size_t> m_places;
    std::vector<std::vector<double>> m_seconds;
};

// From a region to its place in the bucket's floats: pixels first, then weights.
void copyInto(const Target& from, const Rect& region, const Rect& bucket, std::size_t channels,
              std::span<float> to) {
    const auto width = static_cast<std::size_t>(region.width());
    for (std::int32_t y = region.y0; y < region.y1; ++y) {
        const auto row = static_cast<std::size_t>(y - region.y0) * width;
        const auto at =
            static_cast<std::size_t>((y - bucket.y0) * bucket.width() + region.x0 - bucket.x0);
        std::copy_n(from.pixels.data() + row * channels, width * channels,
                    to.data() + at * channels);
        std::copy_n(from.weights.data() + row, width,
                    to.data() + static_cast<std::size_t>(bucket.area()) * channels + at);
    }
}

// The squares of side `side` that a square of side 32 is made of, in the order of `cells`.
template <typename Order>
std::vector<Rect> parts(const Rect& bucket, std::int32_t side, Order order) {
    const std::int32_t columns = bucket.width() / side, rows = bucket.height() / side;
    std::vector<Rect> result;
    for (const std::uint32_t cell : order(columns, rows)) {
        const std::int32_t x = bucket.x0 + static_cast<std::int32_t>(cell) % columns * side;
        const std::int32_t y = bucket.y0 + static_cast<std::int32_t>(cell) / columns * side;
        result.push_back({x, y, x + side, y + side});
    }
    return result;
}

std::vector<std::uint32_t> inRows(std::int32_t columns, std::int32_t rows) {
    return findBucketOrder("row")->cells(columns, rows, 0);
}

std::vector<Rect> regionsInside(const Rect& bucket, OrderScene::Inside way) {
    using Inside = OrderScene::Inside;
    switch (way) {
        case Inside::kBucketRows:
            return {bucket};
        case Inside::kAtomsInRows:
            return parts(bucket, kAtomSizePixels, inRows);
        case Inside::kAtomsOnCurve:
            return parts(bucket, kAtomSizePixels, hilbertOrder);
        case Inside::kPixelRows:
            return parts(bucket, 1, inRows);
        case Inside::kPixelsOnCurve:
            return parts(bucket, 1, hilbertOrder);
        case Inside::kPixelAtomRows:
            break;
    }
    std::vector<Rect> result;
    for (const Rect& atom : parts(bucket, kAtomSizePixels, inRows)) {
        const std::vector<Rect> pixels = parts(atom, 1, inRows);
        result.insert(result.end(), pixels.begin(), pixels.end());
    }
    return result;
}

}  // namespace

OrderScene::OrderScene(std::string name, std::shared_ptr<const Scene> scene,
                       const RenderSettings& settings, PhotonPaging* paging)
    : m_name(std::move(name)),
      m_settings(settings),
      m_renderer(std::make_unique<FrameRenderer>(std::move(scene), settings)) {
    if (paging) m_renderer->pageMaps({paging});
}

void OrderScene::beginPass(int threads) {
    WorkerArena arena(threads);
    arena.execute([&] { m_renderer->beginPass(0, kNeverCancelled, {}); });
}

BucketTimes OrderScene::render(const BucketSetting& setting) {
    BucketTimes times;
    if (setting.begun) setting.begun();
    const double prepareStart = processorSeconds();
    times.prepareSeconds = secondsOf([&] { beginPass(setting.threads); });
    times.prepareProcessorSeconds = processorSeconds() - prepareStart;
    if (setting.prepared) setting.prepared();
    WorkerArena arena(setting.threads);
    const BucketGrid grid(m_settings.window, setting.size);
    const BucketOrder& named = *findBucketOrder(setting.order);
    const auto order = named.cells(grid.columns(), grid.rows(), m_settings.seed);
    const ChannelLayout layout = m_renderer->layout();
    const auto channels = static_cast<std::size_t>(layout.count);
    std::vector<Target> targets(static_cast<std::size_t>(setting.threads));
    AtomTimes atoms(grid);
    BucketWork work;
    work.started = [&](std::uint32_t cell, const Rect& rect) { atoms.begin(cell, rect); };
    work.floatsPerPixel = layout.count + 1;
    work.render = [&](std::uint32_t cell, const Rect& rect, const Rect& atom, int worker,
                      std::span<float> bucket) {
        // Not elapsed time: what other programs take meanwhile is no part of an atom.
        const double start = threadSeconds();
        Target& target = targets[static_cast<std::size_t>(worker)];
        const auto render = [&] { target.render(*m_renderer, atom); };
        if (setting.around)
            setting.around(cell, render);
        else
            render();
        copyInto(target, atom, rect, channels, bucket);
        atoms.at(cell, rect, atom) = threadSeconds() - start;
    };
    work.deliver = [](const RenderedBucket&) {};
    CorrelatedChoice choice(grid, order, setting.threads, setting.missing);
    std::vector<double> choiceSeconds(targets.size());
    if (named.isCorrelated) {
        work.choose = [&](int worker) {
            std::size_t next = 0;
            choiceSeconds[static_cast<std::size_t>(worker)] +=
                secondsOf([&] { next = choice.next(worker); });
            return next;
        };
        work.deliver = [&](const RenderedBucket& bucket) {
            choice.finished(bucket.cell, bucket.pixels, channels,
                            static_cast<std::size_t>(layout.beauty));
        };
    }
    const double processorStart = processorSeconds();
    times.seconds = secondsOf(
        [&] { times.idleSeconds = runBuckets(arena, grid, order, {}, work).idleSeconds; });
    times.processorSeconds = processorSeconds() - processorStart;
    times.choiceSeconds = std::accumulate(choiceSeconds.begin(), choiceSeconds.end(), 0.0);
    times.cells = atoms.cells();
    times.atoms = atoms.take();
    return times;
}

double OrderScene::renderInside(Inside way) {
    beginPass(0);
    const BucketGrid grid(m_settings.window, 32);
    std::vector<Rect> regions;
    for (const std::uint32_t cell : hilbertOrder(grid.columns(), grid.rows())) {
        const std::vector<Rect> inside = regionsInside(grid.cellRect(cell), way);
        regions.insert(regions.end(), inside.begin(), inside.end());
    }
    Target target;
    const double start = processorSeconds();
    for (const Rect& region : regions) target.render(*m_renderer, region);
    return processorSeconds() - start;
}

}  // namespace pm::bench
