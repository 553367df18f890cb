// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>

namespace pm {

// Where a line meets a curved or exact primitive, nearest first, in units of its direction's
// length; also behind its origin.
struct RayRoots {
    std::array<double, 2> t;
    std::uint32_t count = 0;

    void add(double root) { t[count++] = root; }
};

}  // namespace pm
