// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>

#include "integrator/values/stopwatch.h"

namespace pm::plugin {

// How far a render is and how long it still takes: of all that may end it, by what ends it first.
// Passes weigh the same; within one, photons and buckets weigh as the passes before took, and in
// the first by a guess. The fraction never falls, and is below 1 until the render has ended.
// Threads: any.
class ProgressClock {
  public:
    struct Reading {
        double fraction;          // 0 to 1
        double remainingSeconds;  // NaN while too little is known
    };
    // What may end the render.
    struct Ends {
        std::optional<double> passes;       // by their number
        std::optional<double> seconds;      // since the clock was made
        std::optional<double> errorPasses;  // passes to the error target, as far as can be foreseen
    };

    // `hasPhotons`: a pass begins with photons. `seconds`: the time, for tests.
    ProgressClock(const Ends& ends, bool hasPhotons, std::function<double()> seconds = Now());

    // So many passes were made before, in time that doesn't count.
    void startAt(std::uint32_t passes);
    Reading photons(std::uint32_t pass, double fraction);
    Reading buckets(std::uint32_t pass, double fraction);
    // The seconds that the phases of a finished pass took, and how many passes are foreseen now.
    void endPass(double photonSeconds, double bucketSeconds, std::optional<double> errorPasses);

  private:
    struct Now {
        double operator()() const { return watch.seconds(); }
        Stopwatch watch;
    };
    Reading advance(double passes);

    const std::function<double()> m_seconds;
    std::mutex m_mutex;
    Ends m_ends;
    double m_photonShare;
    double m_photonSeconds = 0, m_bucketSeconds = 0;
    double m_first = 0;  // passes made before
    double m_fraction = 0;
};

}  // namespace pm::plugin
