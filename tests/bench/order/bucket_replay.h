// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What a frame's buckets would take with more workers than the machine has: a discrete-event replay
// of what each of their atoms took.
#pragma once

#include <vector>

namespace pm::bench {

struct ReplayRules {
    int workers = 1;           // >= 1
    bool sharesAtoms = true;   // a worker without a bucket helps with the others' atoms
    double bucketSeconds = 0;  // that each bucket costs its worker besides: handing out, sending
};

struct Replay {
    double seconds = 0;      // until the last worker ends
    double busySeconds = 0;  // of all workers, summed
};

// Each worker draws the next bucket when it is free and renders its atoms one by one, as runBuckets
// does it; the one that is free first is served first, of several the one with the lowest number.
// atoms: seconds, of each, by bucket in the order in which they are drawn. Workers don't slow each
// other down.
Replay replayBuckets(const std::vector<std::vector<double>>& atoms, const ReplayRules& rules);

// Work of which a part is not spread over workers (Amdahl).
struct PartlySerial {
    double seconds = 0;      // with one worker
    double serialShare = 1;  // of them, in [0, 1]

    double with(int workers) const { return seconds * (serialShare + (1 - serialShare) / workers); }
};

// The share that makes the work so many times as fast with so many workers; 1 for one worker.
double serialShareOf(double speedUp, int workers);

}  // namespace pm::bench
