// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cmath>
#include <cstdint>

namespace pm {

// Radius of a pass over the first one's: r^2 shrinks by (i + a)/(i + 1) from pass i to the next, so
// that bias and variance both go to 0 over the passes.
// Source: Knaus & Zwicker 2011, eq. 20, alpha = 2/3.
inline float radiusFactor(std::uint32_t pass) {
    double squared = 1.0;
    for (std::uint32_t i = 0; i < pass; ++i) squared *= (i + 2.0 / 3.0) / (i + 1.0);
    return static_cast<float>(std::sqrt(squared));
}

}  // namespace pm
