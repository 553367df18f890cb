// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/order/idle_share.h"

#include "tests/bench/order/bucket_replay.h"

namespace pm::bench {

double idleShare(const std::vector<std::vector<double>>& atoms, int workers, bool sharesAtoms) {
    const Replay replay = replayBuckets(atoms, {workers, sharesAtoms});
    return replay.seconds > 0 ? 1 - replay.busySeconds / (replay.seconds * workers) : 0.0;
}

}  // namespace pm::bench
