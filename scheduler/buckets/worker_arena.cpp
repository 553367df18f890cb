// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/buckets/worker_arena.h"

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>

#include "integrator/values/error.h"
#include "scheduler/buckets/available_threads.h"
#include "scheduler/buckets/fp_environment.h"

namespace pm {
namespace {

constexpr int kMaxThreads = 4096;

int checkedThreads(int threads) {
    if (threads < 0 || threads > kMaxThreads) {
        throw Error(Status::kInvalidArgument,
                    fmt::format("number of threads is {}; it must be from 1 to {}, or 0 for all "
                                "that this process may use",
                                threads, kMaxThreads));
    }
    return threads == 0 ? availableThreads() : threads;
}

// Slots beyond what TBB's pool can fill would stay empty, and asking for them makes TBB print a
// warning on the host's standard error. The limit is only read here.
int fillableSlots(int threads) {
    using oneapi::tbb::global_control;
    const std::size_t limit = global_control::active_value(global_control::max_allowed_parallelism);
    return std::max(1, static_cast<int>(std::min(static_cast<std::size_t>(threads), limit)));
}

}  // namespace

struct WorkerArena::Tbb {
    explicit Tbb(int slots) : arena(slots, /*reserved_for_masters=*/1) {}
    oneapi::tbb::task_arena arena;
};

WorkerArena::WorkerArena(int threads)
    : m_threads(checkedThreads(threads)), m_tbb(std::make_unique<Tbb>(fillableSlots(m_threads))) {
    // An arena keeps the floating-point modes of the thread that initialises it and hands them to
    // its workers: make sure that they are ours and not the host's.
    const FpEnvironment guard;
    m_tbb->arena.initialize();
}

WorkerArena::~WorkerArena() = default;

void WorkerArena::run(void* task, void (*call)(void*)) {
    // For the task contexts that TBB makes on the way in.
    const FpEnvironment callerGuard;
    m_tbb->arena.execute([&] {
        const FpEnvironment workerGuard;
        call(task);
    });
}

}  // namespace pm
