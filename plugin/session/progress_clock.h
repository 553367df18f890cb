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
// The fraction goes by passes, which weigh the same; within one, photons and buckets weigh as the
// passes before took, and in the first by a guess. It never falls, and is below 1 until the render
// has ended. The remaining time goes by what the pass at hand and the one before were measured to
// cost. Threads: any.
class ProgressClock {
  public:
    struct Reading {
        double fraction;          // 0 to 1
        double remainingSeconds;  // NaN while too little is known
    };
    // What may end the render.
    struct Ends {
        std::optional<double> passes{};       // by their number
        std::optional<double> seconds{};      // since the clock was made
        std::optional<double> errorPasses{};  // to the error target, as far as can be foreseen
        // What the buckets of a pass cost from the second on, over those of the first: a guess for
        // as long as nothing is measured.
        double growth = 1.0;
    };

    // `hasPhotons`: a pass begins with photons. `seconds`: the time, for tests.
    ProgressClock(const Ends& ends, bool hasPhotons, std::function<double()> seconds = Now());

    // So many passes, and of the next one's buckets this share, were made before, in time that
    // doesn't count.
    void startAt(std::uint32_t passes, double shareOfNext = 0);
    Reading photons(std::uint32_t pass, double fraction);
    Reading buckets(std::uint32_t pass, double fraction);
    // The seconds that the phases of a finished pass took, how many passes are foreseen now, and
    // what the next one's buckets will cost over this one's.
    void endPass(double photonSeconds, double bucketSeconds, std::optional<double> errorPasses,
                 double nextOverThis = 1.0);

  private:
    struct Now {
        double operator()() const { return watch.seconds(); }
        Stopwatch watch;
    };
    // A part of a pass, and how far it is.
    struct Phase {
        double start = 0;                  // seconds
        double from = 0, done = 0;         // shares
        std::optional<double> foreseen{};  // seconds for all of it
        // Seconds for all of it, by what is measured up to now and by what was foreseen.
        std::optional<double> cost(double now) const;
    };
    // Seconds; NaN where too little is known.
    struct Costs {
        double photons = 0, buckets = 0;  // of a whole pass
        double thisPass = 0;              // what remains of the one at hand
        double growth = 1;                // Ends::growth, as long as it counts

        double toTheEndOf(std::uint32_t pass, double wanted) const;
        double untilLimit(std::uint32_t pass, double left) const;
    };
    Costs costs(std::uint32_t pass, bool inBuckets, double now) const;
    Reading advance(std::uint32_t pass, bool inBuckets, double fraction);

    const std::function<double()> m_seconds;
    const bool m_hasPhotons;
    std::mutex m_mutex;
    Ends m_ends;
    double m_photonShare;
    double m_photonSeconds = 0, m_bucketSeconds = 0;
    double m_fraction = 0;
    bool m_inBuckets = false;  // since the last reading
    Phase m_photons, m_buckets;
};

}  // namespace pm::plugin
