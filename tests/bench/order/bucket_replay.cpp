// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/order/bucket_replay.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <queue>
#include <utility>

namespace pm::bench {

namespace {

// The buckets that workers have drawn, and how far each is.
class OpenBuckets {
  public:
    OpenBuckets(const std::vector<std::vector<double>>& atoms, std::size_t workers)
        : m_atoms(atoms), m_bucket(workers, atoms.size()), m_nextAtom(workers) {}

    bool hasAtoms(std::size_t worker) const {
        const std::size_t bucket = m_bucket[worker];
        return bucket < m_atoms.size() && m_nextAtom[worker] < m_atoms[bucket].size();
    }
    bool draw(std::size_t worker) {
        if (m_drawn == m_atoms.size()) return false;
        m_bucket[worker] = m_drawn++;
        m_nextAtom[worker] = 0;
        return true;
    }
    // Seconds of the next atom of this worker's bucket.
    double take(std::size_t worker) { return m_atoms[m_bucket[worker]][m_nextAtom[worker]++]; }

  private:
    const std::vector<std::vector<double>>& m_atoms;
    std::vector<std::size_t> m_bucket, m_nextAtom;  // of each worker
    std::size_t m_drawn = 0;
};

}  // namespace

Replay replayBuckets(const std::vector<std::vector<double>>& atoms, const ReplayRules& rules) {
    const auto workers = static_cast<std::size_t>(rules.workers);
    OpenBuckets buckets(atoms, workers);
    using Free = std::pair<double, std::size_t>;  // from when on, and who
    std::priority_queue<Free, std::vector<Free>, std::greater<>> queue;
    for (std::size_t worker = 0; worker < workers; ++worker) queue.push({0.0, worker});
    Replay replay;
    while (!queue.empty()) {
        const auto [now, worker] = queue.top();
        queue.pop();
        double seconds = 0;
        std::size_t from = worker;
        if (!buckets.hasAtoms(worker) && buckets.draw(worker)) seconds = rules.bucketSeconds;
        for (std::size_t i = 1; rules.sharesAtoms && !buckets.hasAtoms(from) && i < workers; ++i)
            if (buckets.hasAtoms((worker + i) % workers)) from = (worker + i) % workers;
        if (!buckets.hasAtoms(from)) {
            replay.seconds = std::max(replay.seconds, now);
            continue;
        }
        seconds += buckets.take(from);
        replay.busySeconds += seconds;
        queue.push({now + seconds, worker});
    }
    return replay;
}

double serialShareOf(double speedUp, int workers) {
    if (workers < 2) return 1;
    return std::clamp((workers / speedUp - 1) / (workers - 1), 0.0, 1.0);
}

}  // namespace pm::bench
