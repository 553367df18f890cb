// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/light_sampling/place_cells.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pm {

namespace {

// Extents that differ by less, relative, are alike: rounding is not to choose between them.
constexpr float kAlike = 1e-5f;

}  // namespace

class PlaceCells::Builder {
  public:
    Builder(PlaceCells& cells, std::span<const Receiver> places, std::size_t placesOfALeaf)
        : m_cells(cells), m_places(places), m_order(cells.m_order), m_most(placesOfALeaf) {
        for (const Receiver& place : places) m_keys.push_back(cells.key(place));
        m_order.resize(places.size());
        std::iota(m_order.begin(), m_order.end(), 0u);
        addCell(0, places.size(), 0.0f);
    }

  private:
    // extentAbove: of the cell that this is part of, scene units.
    void addCell(std::size_t begin, std::size_t end, float extentAbove) {
        const std::size_t index = m_cells.m_cells.size();
        m_cells.m_cells.emplace_back();
        std::size_t axis = 0, middle = begin;
        float at = 0.0f;
        if (end - begin > m_most) middle = divide(begin, end, axis, at);
        if (middle == begin) {
            m_cells.m_cells[index].axis = static_cast<std::uint32_t>(m_cells.m_leaves.size());
            m_cells.m_leaves.push_back({begin, end - begin, around(begin, end, extentAbove)});
            return;
        }
        const Region region = around(begin, end, 0.0f);
        const float extent = maxAbsComponent(region.hi - region.lo);
        addCell(begin, middle, extent);
        Cell& cell = m_cells.m_cells[index];
        cell.at = at;
        cell.axis = static_cast<std::uint32_t>(axis);
        cell.right = static_cast<std::uint32_t>(m_cells.m_cells.size());
        addCell(middle, end, extent);
    }

    Region around(std::size_t begin, std::size_t end, float margin) const {
        Region region{m_places[m_order[begin]].position, m_places[m_order[begin]].position};
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3f& p = m_places[m_order[i]].position;
            for (int axis = 0; axis < 3; ++axis) {
                region.lo[axis] = std::min(region.lo[axis], p[axis]);
                region.hi[axis] = std::max(region.hi[axis], p[axis]);
            }
        }
        region.lo -= Vec3f(margin);
        region.hi += Vec3f(margin);
        return region;
    }

    // At the median of the longest axis; `begin` where all are alike.
    std::size_t divide(std::size_t begin, std::size_t end, std::size_t& axis, float& at) {
        Key lo = m_keys[m_order[begin]], hi = lo;
        for (std::size_t i = begin; i < end; ++i)
            for (std::size_t k = 0; k < lo.size(); ++k) {
                lo[k] = std::min(lo[k], m_keys[m_order[i]][k]);
                hi[k] = std::max(hi[k], m_keys[m_order[i]][k]);
            }
        for (std::size_t k = 1; k < lo.size(); ++k)
            if (hi[k] - lo[k] > (1 + kAlike) * (hi[axis] - lo[axis])) axis = k;
        if (!(hi[axis] > lo[axis])) return begin;
        const auto first = m_order.begin() + static_cast<std::ptrdiff_t>(begin);
        const auto last = m_order.begin() + static_cast<std::ptrdiff_t>(end);
        std::sort(first, last, [&](std::uint32_t a, std::uint32_t b) {
            const float x = m_keys[a][axis], y = m_keys[b][axis];
            return x < y || (x == y && a < b);
        });
        // Between two places that differ, as near the median as can be.
        const auto value = [&](std::size_t i) { return m_keys[m_order[i]][axis]; };
        std::size_t middle = begin + (end - begin) / 2;
        while (middle > begin && !(value(middle - 1) < value(middle))) --middle;
        if (middle == begin)
            for (middle = begin + 1; !(value(middle - 1) < value(middle));) ++middle;
        at = value(middle);
        return middle;
    }

    PlaceCells& m_cells;
    std::span<const Receiver> m_places;
    std::vector<std::uint32_t>& m_order;
    std::size_t m_most;
    std::vector<Key> m_keys;
};

PlaceCells::PlaceCells(std::span<const Receiver> places, std::size_t placesOfALeaf,
                       float normalShare) {
    Vec3f lo = places[0].position, hi = lo;
    for (const Receiver& place : places)
        for (int axis = 0; axis < 3; ++axis) {
            lo[axis] = std::min(lo[axis], place.position[axis]);
            hi[axis] = std::max(hi[axis], place.position[axis]);
        }
    m_normalLength = normalShare * length(hi - lo);
    Builder(*this, places, placesOfALeaf);
}

PlaceCells::Key PlaceCells::key(const Receiver& receiver) const {
    const Vec3f normal = receiver.normal * m_normalLength;
    return {receiver.position.x,
            receiver.position.y,
            receiver.position.z,
            normal.x,
            normal.y,
            normal.z};
}

std::uint32_t PlaceCells::leafAt(const Receiver& receiver) const {
    const Key k = key(receiver);
    const Cell* cell = m_cells.data();
    while (cell->right != 0)
        cell = k[cell->axis] < cell->at ? cell + 1 : m_cells.data() + cell->right;
    return m_leaves[cell->axis].region.holds(receiver.position) ? cell->axis : kNoLeaf;
}

}  // namespace pm
