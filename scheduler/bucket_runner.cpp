// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/bucket_runner.h"

#include <fmt/format.h>
#include <oneapi/tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>

#include "integrator/values/error.h"
#include "scheduler/fp_environment.h"

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

// One run: what its workers share.
class Runner {
  public:
    Runner(const BucketGrid& grid, std::span<const std::uint32_t> order, const CancelToken& cancel,
           const BucketWork& work)
        : m_grid(grid), m_order(order), m_cancel(cancel), m_work(work), m_seconds(order.size()) {}

    void runOn(WorkerArena& arena) {
        const auto workers = static_cast<std::size_t>(arena.threads());
        const int tasks = static_cast<int>(std::min(workers, m_order.size()));
        arena.execute([this, tasks] {
            // Isolated: a host that cancels TBB tasks of its own must not silently cancel ours.
            using Context = oneapi::tbb::task_group_context;
            Context context(Context::isolated, Context::default_traits | Context::fp_settings);
            oneapi::tbb::task_group group(context);
            for (int worker = 0; worker < tasks; ++worker) {
                group.run([this, worker] { runWorker(worker); });
            }
            group.wait();
        });
        if (m_failure) std::rethrow_exception(m_failure);
    }

    BucketRun take() {
        const std::size_t done = m_done.load();
        return {done, done < m_order.size() && m_cancel.cancelled(), std::move(m_seconds)};
    }

  private:
    // Draws buckets until there are none left. A bucket that was drawn is always begun: so, when
    // one fails, all before it in the order have run too, and the first failure is well defined.
    void runWorker(int worker) {
        const FpEnvironment guard;
        std::vector<float> buffer;
        while (!m_stop.load(std::memory_order_relaxed) && !m_cancel.cancelled()) {
            const std::size_t ticket = m_ticket.fetch_add(1, std::memory_order_relaxed);
            if (ticket >= m_order.size()) break;
            try {
                runBucket(ticket, worker, buffer);
            } catch (...) {
                fail(ticket);
            }
        }
    }

    void runBucket(std::size_t ticket, int worker, std::vector<float>& buffer) {
        using Clock = std::chrono::steady_clock;
        const auto begin = Clock::now();
        const std::uint32_t cell = m_order[ticket];
        const Rect rect = m_grid.cellRect(cell);
        // What an earlier bucket left in the buffer would depend on who rendered it.
        buffer.assign(
            static_cast<std::size_t>(rect.area()) * static_cast<std::size_t>(m_work.floatsPerPixel),
            0.0f);
        if (m_work.started) m_work.started(cell, rect);
        m_work.render(cell, rect, worker, buffer);
        if (m_cancel.cancelled()) return;  // render may have given up half-way
        m_work.deliver(cell, rect, buffer);
        m_seconds[ticket] = std::chrono::duration<double>(Clock::now() - begin).count();
        m_done.fetch_add(1, std::memory_order_relaxed);
    }

    // Called while an exception is handled.
    void fail(std::size_t ticket) {
        m_stop.store(true, std::memory_order_relaxed);
        const std::lock_guard lock(m_failureMutex);
        if (!m_failure || ticket < m_failedTicket) {
            m_failure = std::current_exception();
            m_failedTicket = ticket;
        }
    }

    const BucketGrid& m_grid;
    const std::span<const std::uint32_t> m_order;
    const CancelToken& m_cancel;
    const BucketWork& m_work;

    std::atomic<std::size_t> m_ticket{0};
    std::atomic<std::size_t> m_done{0};
    std::atomic<bool> m_stop{false};
    std::vector<double> m_seconds;  // each element written by the one worker that drew its ticket

    std::mutex m_failureMutex;  // for the two below
    std::exception_ptr m_failure;
    std::size_t m_failedTicket{};
};

}  // namespace

BucketRun runBuckets(WorkerArena& arena, const BucketGrid& grid,
                     std::span<const std::uint32_t> order, const CancelToken& cancel,
                     const BucketWork& work) {
    checkArguments(grid, order, work);
    Runner runner(grid, order, cancel, work);
    runner.runOn(arena);
    return runner.take();
}

}  // namespace pm
