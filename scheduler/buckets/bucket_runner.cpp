// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/buckets/bucket_runner.h"

#include <fmt/format.h>
#include <oneapi/tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "integrator/values/error.h"
#include "scheduler/buckets/fp_environment.h"

namespace pm {
namespace {

void checkArguments(const BucketGrid& grid, std::span<const std::uint32_t> order,
                    const BucketWork& work) {
    if (!work.render || !work.deliver) {
        throw Error(Status::kInvalidArgument, "bucket work needs both a render and a deliver");
    }
    if (work.floatsPerPixel < 1) {
        throw Error(
            Status::kInvalidArgument,
            fmt::format("bucket work has {} floats a pixel; it must be >= 1", work.floatsPerPixel));
    }
    const std::uint32_t cells = grid.cellCount();
    for (const std::uint32_t cell : order) {
        if (cell >= cells) {
            throw Error(
                Status::kInvalidArgument,
                fmt::format("bucket order has cell {}; the grid has {} cells", cell, cells));
        }
    }
}

using Clock = std::chrono::steady_clock;

// A worker's bucket in work; its atoms are handed out to whoever asks. Only its owner changes rect,
// cell, place and pixels, and only while all atoms are handed out and done. On cache lines of its
// own.
struct alignas(128) OpenBucket {
    std::vector<float> pixels;
    Clock::time_point begun;
    std::size_t place{};  // in the order
    std::uint32_t cell{};
    Rect rect;

    std::mutex mutex;  // of what follows
    std::int32_t atoms{};
    std::int32_t atomsBegun{};
    std::int32_t atomsDone{};
};

// One run: what its workers share.
class Runner {
  public:
    Runner(const BucketGrid& grid, std::span<const std::uint32_t> order, const CancelToken& cancel,
           const BucketWork& work, int workers)
        : m_grid(grid),
          m_order(order),
          m_cancel(cancel),
          m_work(work),
          m_seconds(order.size()),
          m_open(usefulWorkers(workers)),
          m_ended(m_open.size()) {}

    void runOn(WorkerArena& arena) {
        arena.execute([this] {
            // Isolated: a host that cancels TBB tasks of its own must not silently cancel ours.
            using Context = oneapi::tbb::task_group_context;
            Context context(Context::isolated, Context::default_traits | Context::fp_settings);
            oneapi::tbb::task_group group(context);
            for (std::size_t worker = 0; worker < m_open.size(); ++worker) {
                group.run([this, worker] { runWorker(worker); });
            }
            group.wait();
        });
        if (m_failure) std::rethrow_exception(m_failure);
    }

    BucketRun take() {
        BucketRun run;
        run.bucketsDone = m_done.load();
        run.cancelled = run.bucketsDone < m_order.size() && m_cancel.cancelled();
        run.seconds = std::move(m_seconds);
        if (m_ended.empty()) return run;
        const Clock::time_point end = *std::max_element(m_ended.begin(), m_ended.end());
        for (const Clock::time_point& ended : m_ended) {
            run.idleSeconds += std::chrono::duration<double>(end - ended).count();
        }
        return run;
    }

  private:
    // No more than there can be atoms.
    std::size_t usefulWorkers(int workers) const {
        const auto side = static_cast<std::size_t>(m_grid.bucketSize() / kAtomSizePixels);
        return std::min(static_cast<std::size_t>(workers), m_order.size() * side * side);
    }

    bool goesOn() const { return !m_stop.load(std::memory_order_relaxed) && !m_cancel.cancelled(); }

    void runWorker(std::size_t worker) {
        const FpEnvironment guard;
        while (goesOn() && beginBucket(worker)) {
            while (renderAtom(m_open[worker], worker)) {
            }
        }
        help(worker);
        m_ended[worker] = Clock::now();
    }

    // Draws a bucket and opens it; false where there is none left. A bucket that was drawn is
    // always begun, and by its owner's hands finished: so, when one fails, all before it in the
    // order have run too, and the first failure is well defined.
    bool beginBucket(std::size_t worker) {
        OpenBucket& bucket = m_open[worker];
        std::size_t place = m_order.size();
        try {
            place = m_work.choose ? m_work.choose(static_cast<int>(worker))
                                  : m_ticket.fetch_add(1, std::memory_order_relaxed);
            // Others may still be at work on the bucket before: it stays as it is.
            if (place >= m_order.size()) return false;
            prepare(bucket, place);
        } catch (...) {
            fail(place, 0);
            return true;  // it has no atom to render
        }
        const std::lock_guard lock(bucket.mutex);
        bucket.atoms = atomCount(bucket.rect);
        bucket.atomsBegun = bucket.atomsDone = 0;
        m_opened.fetch_add(1, std::memory_order_release);
        return true;
    }

    void prepare(OpenBucket& bucket, std::size_t place) {
        bucket.begun = Clock::now();
        bucket.place = place;
        bucket.cell = m_order[place];
        bucket.rect = m_grid.cellRect(bucket.cell);
        // What an earlier bucket left would depend on who rendered it.
        bucket.pixels.assign(static_cast<std::size_t>(bucket.rect.area()) *
                                 static_cast<std::size_t>(m_work.floatsPerPixel),
                             0.0f);
        if (m_work.started) m_work.started(bucket.cell, bucket.rect);
    }

    // Renders an atom of the bucket, and delivers the bucket when it was the last one; false where
    // all were begun.
    bool renderAtom(OpenBucket& bucket, std::size_t worker) {
        std::int32_t atom = 0;
        {
            const std::lock_guard lock(bucket.mutex);
            if (bucket.atomsBegun == bucket.atoms) return false;
            atom = bucket.atomsBegun++;
        }
        try {
            m_work.render(bucket.cell, bucket.rect, atomOf(bucket.rect, atom),
                          static_cast<int>(worker), bucket.pixels);
            if (m_cancel.cancelled()) return false;  // render may have given up half-way
            {
                const std::lock_guard lock(bucket.mutex);
                if (++bucket.atomsDone < bucket.atoms) return true;
            }
            deliver(bucket);
        } catch (...) {
            fail(bucket.place, atom);
            const std::lock_guard lock(bucket.mutex);
            bucket.atomsBegun = bucket.atoms;
        }
        return true;
    }

    void deliver(const OpenBucket& bucket) {
        const auto seconds = [&] {
            return std::chrono::duration<double>(Clock::now() - bucket.begun).count();
        };
        m_work.deliver({bucket.cell, bucket.rect, bucket.pixels, seconds()});
        m_seconds[bucket.place] = seconds();
        m_done.fetch_add(1, std::memory_order_relaxed);
    }

    // No bucket is left to draw, so none is begun in another's place while it is helped with. Those
    // that were drawn but not opened yet are waited for: microseconds.
    void help(std::size_t worker) {
        bool allOpen = false;
        while (!allOpen && goesOn()) {
            allOpen = m_opened.load(std::memory_order_acquire) == m_order.size();
            for (std::size_t i = 1; i < m_open.size(); ++i) {
                OpenBucket& bucket = m_open[(worker + i) % m_open.size()];
                while (goesOn() && renderAtom(bucket, worker)) {
                }
            }
            if (!allOpen) std::this_thread::yield();
        }
    }

    // Called while an exception is handled.
    void fail(std::size_t place, std::int32_t atom) {
        m_stop.store(true, std::memory_order_relaxed);
        const std::lock_guard lock(m_failureMutex);
        if (!m_failure || std::pair(place, atom) < m_failedAt) {
            m_failure = std::current_exception();
            m_failedAt = {place, atom};
        }
    }

    const BucketGrid& m_grid;
    const std::span<const std::uint32_t> m_order;
    const CancelToken& m_cancel;
    const BucketWork& m_work;

    std::atomic<std::size_t> m_ticket{0};
    std::atomic<std::size_t> m_opened{0};
    std::atomic<std::size_t> m_done{0};
    std::atomic<bool> m_stop{false};
    std::vector<double> m_seconds;           // each element written by the worker that delivers
    std::vector<OpenBucket> m_open;          // one a worker
    std::vector<Clock::time_point> m_ended;  // of each worker

    std::mutex m_failureMutex;  // for the two below
    std::exception_ptr m_failure;
    std::pair<std::size_t, std::int32_t> m_failedAt;
};

}  // namespace

BucketRun runBuckets(WorkerArena& arena, const BucketGrid& grid,
                     std::span<const std::uint32_t> order, const CancelToken& cancel,
                     const BucketWork& work) {
    checkArguments(grid, order, work);
    Runner runner(grid, order, cancel, work, arena.threads());
    runner.runOn(arena);
    return runner.take();
}

}  // namespace pm
