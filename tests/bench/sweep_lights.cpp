// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/sweep.h"

namespace pm::bench {

std::vector<Sweep> lightSweeps() {
    return {};
}

}  // namespace pm::bench
