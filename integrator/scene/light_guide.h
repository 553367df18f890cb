// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "integrator/scene/light_tree.h"
#include "integrator/values/vec.h"

namespace pm {

// Which lights reach where: learnt from shadow rays of places where light will be asked for. Places
// that are near and face alike share a table over clusters of lights; a cluster is chosen by the
// table, a light within it by the LightTree. A share of the choices ignores what was learnt, so
// that what the few rays did not see is found all the same.
// Threads: const functions from any, at once.
class LightGuide {
  public:
    // From one of the receivers to a light below a node of the tree, for the number-th time;
    // nothing where that light can't shine there.
    using Look = std::function<std::optional<Sighting>(std::size_t receiver, std::uint32_t node,
                                                       std::uint32_t number)>;

    // look: called from any thread; a pure function. Works in parallel in the calling TBB arena;
    // the result is the same bits for any number of threads.
    LightGuide(const LightTree& tree, std::span<const Receiver> receivers, const Look& look);

    // As LightTree's of those names, over all lights, whatever nodes the descents name.
    void choose(const Receiver& receiver, std::span<LightDescent> descents) const;
    float probability(const Receiver& receiver, std::uint32_t light) const;

    std::uint64_t memoryBytes() const;

    static constexpr std::size_t kMostClusters = 128;
    // Share of the choices that ignores what was learnt: half by power, half evenly.
    static constexpr float kUntaught = 0.05f;

  private:
    using Key = std::array<float, 6>;  // position, and the normal times a length
    // Of the tree over the receivers.
    struct Cell {
        float at = 0.0f;          // what is less goes left
        std::uint32_t right = 0;  // the left child follows its parent; 0: a leaf
        std::uint32_t axis = 0;   // of Key; of a leaf: the number of its table
    };
    class Learner;

    // Where a table counts: around the places from which it was learnt.
    struct Region {
        Vec3f lo, hi;

        bool holds(const Vec3f& p) const {
            return p.x >= lo.x && p.x <= hi.x && p.y >= lo.y && p.y <= hi.y && p.z >= lo.z &&
                   p.z <= hi.z;
        }
    };

    Key key(const Receiver& receiver) const;
    // Cumulative probabilities of the clusters; the first is above 0, the last 1. Null far from
    // all that was learnt: there the tree chooses alone.
    const float* table(const Receiver& receiver) const;

    const LightTree& m_tree;
    float m_normalLength = 0.0f;            // scene units
    std::vector<std::uint32_t> m_clusters;  // nodes of the light tree
    std::vector<std::uint32_t> m_begins;    // of the clusters' lights in the light tree's order
    std::vector<Cell> m_cells;
    std::vector<Region> m_regions;  // of the leaves
    std::vector<float> m_tables;    // one cluster after another, one leaf after another
};

}  // namespace pm
