// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>

namespace pm::plugin {

// How far a render is and how long it still takes. Passes weigh the same; within one, photons and
// buckets weigh as the passes before took, and in the first by a guess. The fraction never falls.
// Threads: any.
class ProgressClock {
  public:
    struct Reading {
        double fraction;          // 0 to 1
        double remainingSeconds;  // NaN while too little is known
    };

    // `hasPhotons`: a pass begins with photons.
    ProgressClock(std::uint32_t passCount, bool hasPhotons);

    Reading photons(std::uint32_t pass, double fraction);
    Reading buckets(std::uint32_t pass, double fraction);
    // The seconds that the phases of a finished pass took.
    void endPass(double photonSeconds, double bucketSeconds);

  private:
    Reading advance(double fraction);

    const std::chrono::steady_clock::time_point m_start = std::chrono::steady_clock::now();
    const double m_passCount;
    std::mutex m_mutex;
    double m_photonShare;
    double m_photonSeconds = 0, m_bucketSeconds = 0;
    double m_fraction = 0;
};

}  // namespace pm::plugin
