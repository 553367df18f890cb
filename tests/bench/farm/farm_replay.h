// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What a frame takes on a farm of any number of workers: a discrete-event replay of what its
// buckets, photons, maps and files were measured to cost, cut into runs as pm_host farm cuts them.
#pragma once

#include <cstdint>
#include <vector>

namespace pm::bench {

// Of one frame, all its passes, in seconds of one thread alone on its core.
struct FarmCosts {
    std::vector<double> buckets;  // in their order
    std::vector<double> pilot;    // what pm_host farm predicted of them
    double passes = 1;            // a run that was ended goes on with the pass that it was at
    double pilotSeconds = 0;      // until the plan is there
    double startSeconds = 0;      // of each process: libraries, scene read and built
    double mapSeconds = 0;        // of each run: photons read, maps made; all passes
    double photonSeconds = 0;     // of tracing
    double mergeSeconds = 0;      // reading all parts, writing the pictures
    double sceneBytes = 0, photonBytes = 0, partBytes = 0;  // of all parts

    // A render without a farm.
    double localSeconds() const;
};

// The engine, the network and the machines.
struct FarmRules {
    int workers = 1;             // >= 1, of one thread each
    int runs = 0;                // 0: as many as pm_host farm makes
    bool photonsOnce = true;     // else each run traces all of them
    double submitSeconds = 0;    // from the plan to the start of the first task
    double afterPhotons = 0;     // from their end to the start of the first runs
    double dispatchSeconds = 0;  // from a task's end to the start of the next on that worker
    double noticeSeconds = 0;    // from the last task's end until merging begins
    double serverRate = 1e300;   // bytes a second that the file server sends and takes, of all
    double linkRate = 1e300;     // of each worker
    double latencySeconds = 0;   // of each file
    double cores = 1e300;        // that all workers share
    double sharedSpeed = 1;      // of a thread where as many as cores are at work, over one alone
    double slowShare = 0;        // of the workers, evenly spread
    double slowSpeed = 1;        // of these
    double preemptedEvery = 0;  // a task is ended after so many seconds and started again; 0: never
};

struct FarmReplay {
    double seconds = 0;        // from the command to the picture
    double photonSeconds = 0;  // of these, until the photons are there
    double runSeconds = 0;     // of these, until the last run has ended, from the photons on
    double mergeSeconds = 0;   // the rest
    double lastWaits = 0;      // mean of workers between their last run's end and that of the last
    std::uint32_t runs = 0;
};

// Errors: std::logic_error for no bucket, fewer than one worker, or preemption that leaves no time
// for a bucket. Threads: any.
FarmReplay replayFarm(const FarmCosts& costs, const FarmRules& rules);

// Share of the workers' time in which they did what one worker alone would have to do.
double efficiencyOf(const FarmCosts& costs, const FarmReplay& replay, int workers);

}  // namespace pm::bench
