// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

namespace pm {

// Pilots of caustics, each with random numbers of its own: by these in place of a pass's number.
enum CausticPilotPass : std::uint32_t {
    kPilotOfRadii,
    kPilotOfAiming,
    kPilotOfSecondHalf,  // of the radii
    kPilotOfLandings,
    kPilotOfReach,
};

}  // namespace pm
