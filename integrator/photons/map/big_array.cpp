// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/map/big_array.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstring>

namespace pm::big_array {

void zero(void* memory, std::size_t bytes) {
    constexpr std::size_t kAtATime = std::size_t{1} << 18;
    auto* const first = static_cast<unsigned char*>(memory);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, bytes, kAtATime),
                      [first](const auto& r) { std::memset(first + r.begin(), 0, r.size()); });
}

}  // namespace pm::big_array
