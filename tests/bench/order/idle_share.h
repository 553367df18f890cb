// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <vector>

namespace pm::bench {

// The share of the workers' time that they wait for the last one to end, were there so many: each
// draws the next bucket when it is free, as the library does it. sharesAtoms: one without a bucket
// helps with the others' atoms; else it waits. atoms: seconds, of each, by bucket in its order.
double idleShare(const std::vector<std::vector<double>>& atoms, int workers, bool sharesAtoms);

}  // namespace pm::bench
