// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

namespace pm {

// How many gather points so many pixels have, on a lattice of that spacing (pixels).
constexpr double gatherPointsOf(double pixels, float spacing) {
    const auto side = static_cast<double>(spacing);
    return pixels / (side * side);
}

}  // namespace pm
