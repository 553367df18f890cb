// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/scene/light_guide.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

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
        for (const Receiver& receiver : receivers) m_keys.push_back(guide.key(receiver));
        m_order.resize(receivers.size());
        std::iota(m_order.begin(), m_order.end(), 0u);
        addCell(0, receivers.size(), 0.0f);
        m_seen.resize(guide.m_cells.size() * m_clusters);
        guide.m_tables.resize(m_leaves.size() * m_clusters);
        tbb::parallel_for(std::size_t{0}, m_leaves.size(), [&](std::size_t i) { lookFromLeaf(i); });
        gather(0);
        spread(0, std::vector<float>(m_clusters, 1.0f));
    }

  private:
    struct Leaf {
        std::size_t begin, end;  // of its places in m_order
        std::size_t cell;
    };
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

    // extentAbove: of the cell that this is part of, scene units.
    void addCell(std::size_t begin, std::size_t end, float extentAbove) {
        const std::size_t index = m_guide.m_cells.size();
        m_guide.m_cells.emplace_back();
        std::size_t axis = 0, middle = begin;
        float at = 0.0f;
        if (end - begin > kPlacesOfALeaf) middle = divide(begin, end, axis, at);
        if (middle == begin) {
            m_guide.m_cells[index].axis = static_cast<std::uint32_t>(m_leaves.size());
            m_guide.m_regions.push_back(around(begin, end, extentAbove));
            m_leaves.push_back({begin, end, index});
            return;
        }
        const Region region = around(begin, end, 0.0f);
        const float extent = maxAbsComponent(region.hi - region.lo);
        addCell(begin, middle, extent);
        Cell& cell = m_guide.m_cells[index];
        cell.at = at;
        cell.axis = static_cast<std::uint32_t>(axis);
        cell.right = static_cast<std::uint32_t>(m_guide.m_cells.size());
        addCell(middle, end, extent);
    }

    Region around(std::size_t begin, std::size_t end, float margin) const {
        Region region{m_receivers[m_order[begin]].position, m_receivers[m_order[begin]].position};
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3f& p = m_receivers[m_order[i]].position;
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
            if (hi[k] - lo[k] > hi[axis] - lo[axis]) axis = k;
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

    // What would arrive from each cluster is known well enough; what is in between must be looked
    // for, though not often where little is to be expected.
    void lookFromLeaf(std::size_t table) {
        const Leaf& leaf = m_leaves[table];
        const std::size_t places = leaf.end - leaf.begin;
        const auto placeOf = [&](std::size_t i) { return m_order[leaf.begin + i % places]; };
        const std::span<float> expected(m_guide.m_tables.data() + table * m_clusters, m_clusters);
        float total = 0.0f;
        for (std::size_t c = 0; c < m_clusters; ++c) {
            for (std::size_t i = 0; i < places; ++i)
                expected[c] += m_guide.m_tree.importance(m_guide.m_clusters[c],
                                                         m_receivers[placeOf(i)], kLevels);
            total += expected[c];
        }
        for (std::size_t c = 0; c < m_clusters; ++c) {
            const bool little = expected[c] * static_cast<float>(m_clusters) < kLittle * total;
            for (std::uint32_t i = 0; i < (little ? 1 : kLooks); ++i)
                if (const auto sighting = m_look(placeOf(i + c), m_guide.m_clusters[c], i))
                    m_seen[leaf.cell * m_clusters + c].add(*sighting, m_guide.m_tree);
        }
    }

    // Sums up what was seen.
    void gather(std::size_t index) {
        const Cell& cell = m_guide.m_cells[index];
        if (cell.right == 0) return;
        for (const std::size_t child : {index + 1, std::size_t{cell.right}}) {
            gather(child);
            for (std::size_t c = 0; c < m_clusters; ++c)
                m_seen[index * m_clusters + c].add(m_seen[child * m_clusters + c]);
        }
    }

    // Hands down how much more or less of a cluster is visible than anywhere, as far as is known;
    // makes the leaves' tables of it.
    void spread(std::size_t index, const std::vector<float>& above) {
        std::vector<float> ratios(m_clusters);
        for (std::size_t c = 0; c < m_clusters; ++c) {
            const Seen& seen = m_seen[index * m_clusters + c];
            ratios[c] = (seen.ratios + kPriorLooks * above[c]) / (seen.looks + kPriorLooks);
        }
        const Cell& cell = m_guide.m_cells[index];
        if (cell.right == 0) {
            makeTable(cell.axis, ratios);
            return;
        }
        spread(index + 1, ratios);
        spread(cell.right, ratios);
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
    std::vector<Key> m_keys;
    std::vector<std::uint32_t> m_order;
    std::vector<Leaf> m_leaves;
    std::vector<Seen> m_seen;  // of the cells, cluster after cluster
};

LightGuide::LightGuide(const LightTree& tree, std::span<const Receiver> receivers, const Look& look)
    : m_tree(tree), m_clusters(tree.cut(kMostClusters)) {
    for (const std::uint32_t node : m_clusters) m_begins.push_back(tree.begin(node));
    Vec3f lo = receivers[0].position, hi = lo;
    for (const Receiver& receiver : receivers)
        for (int axis = 0; axis < 3; ++axis) {
            lo[axis] = std::min(lo[axis], receiver.position[axis]);
            hi[axis] = std::max(hi[axis], receiver.position[axis]);
        }
    m_normalLength = kNormalShare * length(hi - lo);
    Learner(*this, receivers, look);
}

LightGuide::Key LightGuide::key(const Receiver& receiver) const {
    const Vec3f normal = receiver.normal * m_normalLength;
    return {receiver.position.x,
            receiver.position.y,
            receiver.position.z,
            normal.x,
            normal.y,
            normal.z};
}

const float* LightGuide::table(const Receiver& receiver) const {
    const Key k = key(receiver);
    const Cell* cell = m_cells.data();
    while (cell->right != 0)
        cell = k[cell->axis] < cell->at ? cell + 1 : m_cells.data() + cell->right;
    if (!m_regions[cell->axis].holds(receiver.position)) return nullptr;
    return m_tables.data() + std::size_t{cell->axis} * m_clusters.size();
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
    return m_tables.size() * sizeof(float) + m_cells.size() * sizeof(Cell) +
           m_regions.size() * sizeof(Region) +
           (m_clusters.size() + m_begins.size()) * sizeof(std::uint32_t);
}

}  // namespace pm
