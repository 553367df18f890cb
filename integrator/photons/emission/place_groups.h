// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "integrator/values/cancel_check.h"
#include "integrator/values/vec.h"

namespace pm {

// The group, below `groups`, of each place: divided at the median, the axis in turn, until there
// are so many. Their sizes differ by one at most for each division; of fewer places than groups
// some have none. groups: a power of two, at most 256. Throws Error(kCancelled) soon after cancel
// is set. Threads: any.
std::vector<std::uint8_t> groupByPlace(std::span<const Vec3d> places, std::size_t groups,
                                       const CancelCheck& cancel = {});

}  // namespace pm
