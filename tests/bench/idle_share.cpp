// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/idle_share.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <queue>

namespace pm::bench {

double idleShare(const std::vector<std::vector<double>>& atoms, int workers, bool sharesAtoms) {
    struct Worker {
        double free;
        std::size_t index;
        bool operator>(const Worker& other) const { return free > other.free; }
    };
    const auto count = static_cast<std::size_t>(workers);
    std::priority_queue<Worker, std::vector<Worker>, std::greater<>> queue;
    for (std::size_t i = 0; i < count; ++i) queue.push({0.0, i});
    std::vector<std::size_t> bucketOf(count), nextAtom(count);  // of each worker
    std::vector<bool> hasBucket(count);
    std::size_t drawn = 0;
    double busy = 0, end = 0;
    const auto hasAtoms = [&](std::size_t i) {
        return hasBucket[i] && nextAtom[i] < atoms[bucketOf[i]].size();
    };
    while (!queue.empty()) {
        const Worker worker = queue.top();
        queue.pop();
        std::size_t at = worker.index;
        if (!hasAtoms(at) && drawn < atoms.size()) {
            bucketOf[at] = drawn++;
            nextAtom[at] = 0;
            hasBucket[at] = true;
        }
        for (std::size_t i = 1; sharesAtoms && !hasAtoms(at) && i < count; ++i)
            if (hasAtoms((worker.index + i) % count)) at = (worker.index + i) % count;
        if (!hasAtoms(at)) {
            end = std::max(end, worker.free);
            continue;
        }
        const double seconds = atoms[bucketOf[at]][nextAtom[at]++];
        busy += seconds;
        queue.push({worker.free + seconds, worker.index});
    }
    return end > 0 ? 1 - busy / (end * workers) : 0.0;
}

}  // namespace pm::bench
