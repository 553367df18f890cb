// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors

// The end of a run: workers without a bucket of their own help with the atoms of the others'.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>

#include "scheduler/buckets/bucket_runner.h"
#include "scheduler/buckets/static_orders.h"

namespace pm {
namespace {

class BucketTail : public ::testing::Test {
  protected:
    // As a host that lets TBB have more threads than the machine has: real concurrency.
    oneapi::tbb::global_control m_limit{oneapi::tbb::global_control::max_allowed_parallelism, 8};
    CancelToken m_cancel;
    std::atomic<int> m_started{0}, m_delivered{0}, m_atoms{0};

    // Counts; render calls body(atom, worker) for each atom.
    template <typename Body>
    BucketWork countingWork(Body body) {
        BucketWork work;
        work.floatsPerPixel = 1;
        work.started = [this](std::uint32_t, const Rect&) { ++m_started; };
        work.render = [this, body](std::uint32_t, const Rect&, const Rect& atom, int worker,
                                   std::span<float>) {
            ++m_atoms;
            body(atom, worker);
        };
        work.deliver = [this](const RenderedBucket&) { ++m_delivered; };
        return work;
    }
};

// Opens once this many different workers are at it; gives up for good, and says so, after a while.
class Meeting {
  public:
    explicit Meeting(std::size_t workers) : m_wanted(workers) {}

    bool come(int worker) {
        std::unique_lock lock(m_mutex);
        m_here.insert(worker);
        m_changed.notify_all();
        const auto isOpen = [this] { return m_gaveUp || m_here.size() >= m_wanted; };
        if (!m_changed.wait_for(lock, std::chrono::seconds(20), isOpen)) m_gaveUp = true;
        return !m_gaveUp;
    }

  private:
    const std::size_t m_wanted;
    std::mutex m_mutex;
    std::condition_variable m_changed;
    std::set<int> m_here;
    bool m_gaveUp = false;
};

TEST_F(BucketTail, oneBucketIsRenderedByAllWorkers) {
    constexpr int kWorkers = 4;
    WorkerArena arena(kWorkers);
    const BucketGrid grid({-3, 2, 61, 60}, 128);
    ASSERT_EQ(grid.cellCount(), 1u);
    Meeting meeting(kWorkers);
    std::atomic<bool> met{true};
    BucketWork work = countingWork([&](const Rect&, int worker) {
        if (!meeting.come(worker)) met = false;
    });
    // Before there is an atom to help with the others find nothing to do, and stay.
    work.started = [this](std::uint32_t, const Rect&) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        ++m_started;
    };
    const BucketRun run = runBuckets(arena, grid, rowOrder(1, 1), m_cancel, work);
    EXPECT_TRUE(met) << "no one came to help";
    EXPECT_EQ(run.bucketsDone, 1u);
    EXPECT_EQ(m_started, 1);
    EXPECT_EQ(m_delivered, 1);
    EXPECT_EQ(m_atoms, 9 * 8) << "from -8 to 64 by 0 to 64";
}

TEST_F(BucketTail, everyAtomOnceAndEveryBucketOnce) {
    for (const int workers : {1, 2, 3, 8}) {
        for (const std::int32_t size : {8, 24, 64, 256}) {
            const Rect window{-13, 5, 190, 121};
            WorkerArena arena(workers);
            const BucketGrid grid(window, size);
            std::mutex mutex;
            std::set<std::pair<std::int32_t, std::int32_t>> corners;
            std::int64_t area = 0;
            m_started = m_delivered = 0;
            const BucketRun run =
                runBuckets(arena, grid, rowOrder(grid.columns(), grid.rows()), m_cancel,
                           countingWork([&](const Rect& atom, int) {
                               const std::lock_guard lock(mutex);
                               const Rect whole = wholeAtoms(atom);
                               EXPECT_EQ(whole.area(), kAtomPixels);
                               EXPECT_TRUE(corners.insert({whole.x0, whole.y0}).second);
                               area += atom.area();
                           }));
            EXPECT_EQ(area, window.area()) << workers << " workers, size " << size;
            EXPECT_EQ(m_started, static_cast<int>(grid.cellCount()));
            EXPECT_EQ(m_delivered, m_started);
            EXPECT_EQ(run.bucketsDone, grid.cellCount());
        }
    }
}

// Two atoms of one bucket fail on two workers, the later one first in every other turn.
TEST_F(BucketTail, firstFailureWithinABucketIsRethrown) {
    const BucketGrid grid({0, 0, 32, 8}, 32);
    WorkerArena arena(2);
    for (int turn = 0; turn < 20; ++turn) {
        Meeting meeting(2);
        const BucketWork work = countingWork([&](const Rect& atom, int worker) {
            if (atom.x0 >= 16) return;
            const bool first = atom.x0 == 0;
            meeting.come(worker);
            if (first == (turn % 2 == 0)) std::this_thread::sleep_for(std::chrono::milliseconds(2));
            throw std::runtime_error(first ? "first" : "second");
        });
        try {
            runBuckets(arena, grid, rowOrder(1, 1), m_cancel, work);
            FAIL() << "nothing was thrown";
        } catch (const std::runtime_error& error) {
            EXPECT_STREQ(error.what(), "first");
        }
    }
    EXPECT_EQ(m_delivered, 0);
}

TEST_F(BucketTail, cancelDropsABucketThatOthersHelpWith) {
    const BucketGrid grid({0, 0, 128, 128}, 128);
    WorkerArena arena(4);
    Meeting meeting(2);
    const BucketRun run = runBuckets(arena, grid, rowOrder(1, 1), m_cancel,
                                     countingWork([&](const Rect&, int worker) {
                                         meeting.come(worker);
                                         m_cancel.cancel();
                                     }));
    EXPECT_TRUE(run.cancelled);
    EXPECT_EQ(run.bucketsDone, 0u);
    EXPECT_EQ(m_delivered, 0);
    EXPECT_LE(m_atoms, 4 + 4) << "at most one more than the one in work for each";
}

TEST_F(BucketTail, choiceDecidesWhatIsNext) {
    const BucketGrid grid({0, 0, 64, 8}, 8);
    WorkerArena arena(1);
    std::size_t left = 8;
    std::vector<std::uint32_t> begun;
    BucketWork work = countingWork([](const Rect&, int) {});
    work.started = [&](std::uint32_t cell, const Rect&) { begun.push_back(cell); };
    work.choose = [&](int worker) {
        EXPECT_EQ(worker, 0);
        return left > 0 ? --left : std::size_t{8};
    };
    const BucketRun run = runBuckets(arena, grid, rowOrder(8, 1), m_cancel, work);
    EXPECT_EQ(run.bucketsDone, 8u);
    EXPECT_EQ(begun, (std::vector<std::uint32_t>{7, 6, 5, 4, 3, 2, 1, 0}));
    work.choose = [](int) -> std::size_t { throw std::runtime_error("choice"); };
    EXPECT_THROW(runBuckets(arena, grid, rowOrder(8, 1), m_cancel, work), std::runtime_error);
}

// Two buckets of one atom each, on two workers; one of them lingers. Once in a few turns the other
// is surely not held up by something else.
TEST_F(BucketTail, waitingIsCounted) {
    const BucketGrid grid({0, 0, 16, 8}, 8);
    WorkerArena arena(2);
    double idle = 0;
    for (int turn = 0; turn < 20 && idle < 0.01; ++turn) {
        Meeting meeting(2);
        idle = runBuckets(arena, grid, rowOrder(2, 1), m_cancel,
                          countingWork([&](const Rect& atom, int worker) {
                              meeting.come(worker);
                              if (atom.x0 == 0)
                                  std::this_thread::sleep_for(std::chrono::milliseconds(30));
                          }))
                   .idleSeconds;
    }
    EXPECT_GE(idle, 0.01);
    WorkerArena one(1);
    EXPECT_EQ(runBuckets(one, grid, rowOrder(2, 1), m_cancel, countingWork([](const Rect&, int) {}))
                  .idleSeconds,
              0.0);
}

}  // namespace
}  // namespace pm
