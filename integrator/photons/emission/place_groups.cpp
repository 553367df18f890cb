// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/emission/place_groups.h"

#include <algorithm>
#include <numeric>

namespace pm {

std::vector<std::uint8_t> groupByPlace(std::span<const Vec3d> places, std::size_t groups,
                                       const CancelCheck& cancel) {
    const std::size_t count = places.size();
    std::vector<std::uint8_t> groupOf(count, 0);
    // Group after group.
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    const auto at = [&](std::size_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
    int axis = 0;
    for (std::size_t made = 1; made < groups; made *= 2, axis = (axis + 1) % 3)
        for (std::size_t begin = 0, end = 0; begin < count; begin = end) {
            const std::uint8_t group = groupOf[order[begin]];
            while (end < count && groupOf[order[end]] == group) ++end;
            std::stable_sort(at(begin), at(end), [&](std::uint32_t a, std::uint32_t b) {
                // For each comparison: a load of a flag, where millions of places take seconds.
                cancel.throwIfSet("grouping places");
                return places[a][axis] < places[b][axis];
            });
            const std::size_t middle = begin + (end - begin + 1) / 2;
            for (std::size_t i = begin; i < end; ++i)
                groupOf[order[i]] = static_cast<std::uint8_t>(2 * group + (i < middle ? 0 : 1));
        }
    return groupOf;
}

}  // namespace pm
