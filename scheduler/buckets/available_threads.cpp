// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/buckets/available_threads.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "scheduler/buckets/cgroup_limits.h"

#if defined(__linux__)
#include <sched.h>

#include <vector>
#endif

namespace pm {
namespace {

int affinityProcessors() {
#if defined(__linux__)
    // The kernel refuses a mask smaller than its own, whose size it does not tell.
    for (std::size_t sets = 1; sets <= 256; sets *= 2) {
        std::vector<cpu_set_t> mask(sets);
        const std::size_t bytes = sets * sizeof(cpu_set_t);
        if (sched_getaffinity(0, bytes, mask.data()) == 0) return CPU_COUNT_S(bytes, mask.data());
    }
#endif
    return static_cast<int>(std::thread::hardware_concurrency());
}

}  // namespace

int availableThreads() {
    const int processors = std::max(1, affinityProcessors());
    const auto limit = cgroupProcessorLimit();
    if (!limit || *limit >= processors) return processors;
    return std::max(1, static_cast<int>(std::ceil(*limit)));
}

}  // namespace pm
