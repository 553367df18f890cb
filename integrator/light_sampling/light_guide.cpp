// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/light_sampling/light_guide.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace pm {

namespace {

// A leaf holds at least half as many places.
constexpr std::size_t kPlacesOfALeaf = 4;
// Shadow rays to a cluster from the places of a leaf.
constexpr std::uint32_t kLooks = 2;
// ... or one, to those from which less than this share of the mean may be expected.
constexpr float kLittle = 0.3f;
// What is known of a cluster from the cell above counts for so many of them.
constexpr float kPriorLooks = 2.0f;
// Bounds of what those few rays make of the choice: what none of them saw is there, perhaps.
constexpr float kLeastFactor = 0.2f, kMostFactor = 1.5f;
// What may arrive from a cluster is summed over the nodes so many levels below it.
constexpr int kLevels = 3;
// Turning by a right angle counts as a step of this share of the places' extent: floor and wall
// come apart where they are near each other, walls stay whole until they are small.
constexpr float kNormalShare = 0.1f;

}  // namespace

class LightGuide::Learner {
  public:
    Learner(LightGuide& guide, std::span<const Receiver> receivers, const Look& look)
        : m_guide(guide),
          m_receivers(receivers),
          m_look(look),
          m_clusters(guide.m_clusters.size()) {
        m_seen.resize(guide.m_cells.cells().size() * m_clusters);
        guide.m_tables.resize(guide.m_cells.leaves() * m_clusters);
        tbb::parallel_for(std::size_t{0}, guide.m_cells.cells().size(),
                          [&](std::size_t i) { lookFromCell(i); });
        gather();
        guide.m_cells.spread(
            std::vector<float>(m_clusters, 1.0f),
            [this](std::size_t cell, const auto& above) { return learnCell(cell, above); });
    }

  private:
    // Of a cluster's lights from the places of a cell.
    struct Seen {
        float looks = 0.0f;
        float ratios = 0.0f;  // of 1 where visible, else 0, over the light's visibility anywhere

        void add(const Sighting& sighting, const LightTree& tree) {
            looks += 1.0f;
            if (sighting.visible) ratios += 1.0f / tree.visibility(sighting.light);
        }
        void add(const Seen& other) {
            looks += other.looks;
            ratios += other.ratios;
        }
    };

    // What would arrive from each cluster is known well enough; what is in between must be looked
    // for, though not often where little is to be expected.
    void lookFromCell(std::size_t index) {
        const PlaceCells::Cell& cell = m_guide.m_cells.cells()[index];
        if (cell.right != 0) return;
        const std::span<const std::uint32_t> places = m_guide.m_cells.placesOf(cell.axis);
        const auto placeOf = [&](std::size_t i) { return places[i % places.size()]; };
        const std::span<float> expected(
            m_guide.m_tables.data() + std::size_t{cell.axis} * m_clusters, m_clusters);
        float total = 0.0f;
        for (std::size_t c = 0; c < m_clusters; ++c) {
            for (std::size_t i = 0; i < places.size(); ++i)
                expected[c] += m_guide.m_tree.importance(m_guide.m_clusters[c],
                                                         m_receivers[placeOf(i)], kLevels);
            total += expected[c];
        }
        for (std::size_t c = 0; c < m_clusters; ++c) {
            const bool little = expected[c] * static_cast<float>(m_clusters) < kLittle * total;
            for (std::uint32_t i = 0; i < (little ? 1 : kLooks); ++i)
                if (const auto sighting = m_look(placeOf(i + c), m_guide.m_clusters[c], i))
                    m_seen[index * m_clusters + c].add(*sighting, m_guide.m_tree);
        }
    }

    // Sums up what was seen.
    void gather() {
        m_guide.m_cells.gather([this](std::size_t cell, std::size_t left, std::size_t right) {
            for (std::size_t c = 0; c < m_clusters; ++c) {
                Seen& seen = m_seen[cell * m_clusters + c];
                seen.add(m_seen[left * m_clusters + c]);
                seen.add(m_seen[right * m_clusters + c]);
            }
        });
    }

    // How much more or less of each cluster is visible than anywhere, as far as is known; of a
    // leaf, the table of it, too.
    std::vector<float> learnCell(std::size_t index, const std::vector<float>& above) {
        std::vector<float> ratios(m_clusters);
        for (std::size_t c = 0; c < m_clusters; ++c) {
            const Seen& seen = m_seen[index * m_clusters + c];
            ratios[c] = (seen.ratios + kPriorLooks * above[c]) / (seen.looks + kPriorLooks);
        }
        const PlaceCells::Cell& cell = m_guide.m_cells.cells()[index];
        if (cell.right == 0) makeTable(cell.axis, ratios);
        return ratios;
    }

    // The variance of the sum is least when each cluster is chosen by the root of its second
    // moment. Within it lights are chosen by f sqrt(v), f what would arrive and v their visibility
    // anywhere; the moment is then the square of the sum of that, times the mean of the visibility
    // from here over that anywhere.
    void makeTable(std::size_t leaf, const std::vector<float>& ratios) {
        const std::span<float> weights(m_guide.m_tables.data() + leaf * m_clusters, m_clusters);
        double total = 0, power = 0;
        for (std::size_t c = 0; c < m_clusters; ++c) {
            weights[c] *= std::clamp(std::sqrt(ratios[c]), kLeastFactor, kMostFactor);
            total += static_cast<double>(weights[c]);
            power += static_cast<double>(m_guide.m_tree.power(m_guide.m_clusters[c]));
        }
        const bool any = total > 0 && std::isfinite(total);
        const double untaught = any ? static_cast<double>(kUntaught) : 1.0;
        double sum = 0;
        for (std::size_t c = 0; c < m_clusters; ++c) {
            if (any) sum += (1.0 - untaught) * static_cast<double>(weights[c]) / total;
            // Half of it evenly: weak clusters don't round to nothing.
            const auto share = static_cast<double>(m_guide.m_tree.power(m_guide.m_clusters[c]));
            sum += untaught * 0.5 * (share / power + 1.0 / static_cast<double>(m_clusters));
            weights[c] = c + 1 == m_clusters ? 1.0f : static_cast<float>(std::min(1.0, sum));
        }
    }

    LightGuide& m_guide;
    std::span<const Receiver> m_receivers;
    const Look& m_look;
    std::size_t m_clusters;
    std::vector<Seen> m_seen;  // of the cells, cluster after cluster
};

LightGuide::LightGuide(const LightTree& tree, std::span<const Receiver> receivers, const Look& look)
    : m_tree(tree),
      m_cells(receivers, kPlacesOfALeaf, kNormalShare),
      m_clusters(tree.cut(kMostClusters)) {
    for (const std::uint32_t node : m_clusters) m_begins.push_back(tree.begin(node));
    Learner(*this, receivers, look);
}

const float* LightGuide::table(const Receiver& receiver) const {
    const std::uint32_t leaf = m_cells.leafAt(receiver);
    if (leaf == PlaceCells::kNoLeaf) return nullptr;
    return m_tables.data() + std::size_t{leaf} * m_clusters.size();
}

void LightGuide::choose(const Receiver& receiver, std::span<LightDescent> descents) const {
    const float* const cumulative = table(receiver);
    for (LightDescent& descent : descents) {
        descent.node = LightTree::kRoot;
        if (!cumulative) continue;
        // The first that is above u, without a branch that none can foresee.
        const float* chosen = cumulative;
        for (std::size_t left = m_clusters.size() - 1; left > 0;) {
            const std::size_t half = (left + 1) / 2;
            chosen += descent.u >= static_cast<double>(chosen[half - 1]) ? half : 0;
            left -= half;
        }
        const float below = chosen == cumulative ? 0.0f : chosen[-1];
        const float share = *chosen - below;
        descent.node = m_clusters[static_cast<std::size_t>(chosen - cumulative)];
        descent.probability *= share;
        descent.u = (descent.u - static_cast<double>(below)) / static_cast<double>(share);
    }
    m_tree.choose(receiver, descents);
}

float LightGuide::probability(const Receiver& receiver, std::uint32_t light) const {
    const float* cumulative = table(receiver);
    if (!cumulative) return m_tree.probability(LightTree::kRoot, receiver, light);
    const auto after = std::upper_bound(m_begins.begin(), m_begins.end(), m_tree.position(light));
    const auto cluster = static_cast<std::size_t>(after - m_begins.begin()) - 1;
    const float share = cumulative[cluster] - (cluster == 0 ? 0.0f : cumulative[cluster - 1]);
    return share * m_tree.probability(m_clusters[cluster], receiver, light);
}

std::uint64_t LightGuide::memoryBytes() const {
    return m_tables.size() * sizeof(float) + m_cells.memoryBytes() +
           (m_clusters.size() + m_begins.size()) * sizeof(std::uint32_t);
}

}  // namespace pm
