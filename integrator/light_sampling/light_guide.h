// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "integrator/light_sampling/light_tree.h"
#include "integrator/light_sampling/place_cells.h"

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
    class Learner;

    // Cumulative probabilities of the clusters; the first is above 0, the last 1. Null far from
    // all that was learnt: there the tree chooses alone.
    const float* table(const Receiver& receiver) const;

    const LightTree& m_tree;
    PlaceCells m_cells;
    std::vector<std::uint32_t> m_clusters;  // nodes of the light tree
    std::vector<std::uint32_t> m_begins;    // of the clusters' lights in the light tree's order
    std::vector<float> m_tables;            // one cluster after another, one leaf after another
};

}  // namespace pm
