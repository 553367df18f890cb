// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "integrator/light_sampling/light_tree.h"
#include "integrator/values/vec.h"

namespace pm {

// Places where light is asked for, put together with those that are near and face alike: a tree
// whose leaves hold a few each, for what is learnt at them.
// Threads: const functions from any, at once.
class PlaceCells {
  public:
    static constexpr std::uint32_t kNoLeaf = ~std::uint32_t{0};

    // Of the tree. The left child follows its parent.
    struct Cell {
        float at = 0.0f;          // what is less goes left
        std::uint32_t right = 0;  // the right child; 0: a leaf
        std::uint32_t axis = 0;   // of the key; of a leaf: its number
    };

    // At least one place. A leaf holds at most placesOfALeaf, but for those that are all alike.
    // normalShare: turning by a right angle counts as a step of this share of the places' extent;
    // 0: places that are near are together whatever they face.
    PlaceCells(std::span<const Receiver> places, std::size_t placesOfALeaf, float normalShare);

    std::span<const Cell> cells() const { return m_cells; }
    std::size_t leaves() const { return m_leaves.size(); }
    // Numbers of the places in a leaf.
    std::span<const std::uint32_t> placesOf(std::size_t leaf) const {
        return std::span(m_order).subspan(m_leaves[leaf].begin, m_leaves[leaf].count);
    }
    // Upwards: merge(cell, left, right) for every cell that has children, after those.
    template <typename Merge>
    void gather(Merge merge) const {
        for (std::size_t i = m_cells.size(); i-- > 0;)
            if (m_cells[i].right != 0) merge(i, i + 1, std::size_t{m_cells[i].right});
    }
    // Downwards: what is known of a cell is step(cell, what is known of the one above).
    template <typename Known, typename Step>
    void spread(const Known& above, const Step& step, std::size_t cell = 0) const {
        const Known known = step(cell, above);
        if (m_cells[cell].right == 0) return;
        spread(known, step, cell + 1);
        spread(known, step, m_cells[cell].right);
    }
    // The leaf's number; kNoLeaf far from all places.
    std::uint32_t leafAt(const Receiver& receiver) const;

    std::uint64_t memoryBytes() const {
        return m_cells.size() * sizeof(Cell) + m_leaves.size() * sizeof(Leaf) +
               m_order.size() * sizeof(std::uint32_t);
    }

  private:
    using Key = std::array<float, 6>;  // position, and the normal times a length
    struct Region {
        Vec3f lo, hi;

        bool holds(const Vec3f& p) const {
            return p.x >= lo.x && p.x <= hi.x && p.y >= lo.y && p.y <= hi.y && p.z >= lo.z &&
                   p.z <= hi.z;
        }
    };
    struct Leaf {
        std::size_t begin, count;  // of its places in m_order
        Region region;             // where it counts: around its places
    };
    class Builder;

    Key key(const Receiver& receiver) const;

    float m_normalLength = 0.0f;  // scene units
    std::vector<std::uint32_t> m_order;
    std::vector<Cell> m_cells;
    std::vector<Leaf> m_leaves;
};

}  // namespace pm
