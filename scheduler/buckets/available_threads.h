// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

namespace pm {

// How many threads this process may keep busy, at least 1: the processors of its affinity mask,
// or fewer where a cgroup (version 2 or 1) gives it less processor time than that; a share of a
// processor counts as one.
// Threads: any; reads small files, so call it once a render.
int availableThreads();

}  // namespace pm
