// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/light_sampling/light_tree.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

namespace pm {

namespace {

// With more lights than a processor's near memory has nodes for, a leaf holds a run of lights ...
constexpr std::size_t kMostSingle = 4096;
constexpr std::size_t kRun = 12;
// ... and a longer one with very many: nodes are no more than about twice this, some 32 MB.
constexpr std::size_t kMostLeaves = 1 << 16;
// A node is divided in the middle of its longest axis, unless one part then has less than this
// share of the lights: the tree stays shallow.
constexpr std::size_t kLeastShare = 8;
constexpr double kAlike = 1e-5;  // sides that differ by less, relative
// Parts with fewer lights than this are not worth a thread of their own.
constexpr std::size_t kFewLights = 4096;
// Of a leaf's choices this share is made evenly, so that no light is forgotten.
constexpr double kEvenShare = 1e-4;

// So many sightings is what is known of the node above worth; and no light counts as hidden more
// often than all but this.
constexpr float kPriorSightings = 2.0f;
constexpr float kLeastVisible = 0.01f;

float sineOf(float cosine) {
    return std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
}

}  // namespace

class LightTree::Builder {
  public:
    Builder(LightTree& tree, const CancelCheck& cancel) : m_tree(tree), m_cancel(cancel) {
        const std::span<const Light> lights = tree.m_scene->nearLights();
        m_bounds.resize(lights.size());
        tbb::parallel_for(std::size_t{0}, lights.size(), [&](std::size_t i) {
            goOn();
            m_bounds[i] = lights[i].extent(*tree.m_scene);
        });
        if (lights.size() > kMostSingle)
            m_run = std::max(kRun, (lights.size() + kMostLeaves - 1) / kMostLeaves);
        tree.m_order.resize(lights.size());
        std::iota(tree.m_order.begin(), tree.m_order.end(), 0u);
        add(0, lights.size(), tree.m_nodes);
        tree.m_visibility.assign(lights.size(), 1.0f);
        tree.m_positions.resize(lights.size());
        for (std::uint32_t i = 0; i < lights.size(); ++i) tree.m_positions[tree.m_order[i]] = i;
        sumUpLeaves();
    }

  private:
    // For each light of each step: a load of a flag, where millions of lights take seconds.
    void goOn() const { m_cancel.throwIfSet("building the tree of lights"); }

    Vec3d centre(std::uint32_t light) const {
        goOn();
        return (m_bounds[light].lo + m_bounds[light].hi) * 0.5;
    }

    // Appends the nodes of a part of the order to `nodes`.
    void add(std::size_t begin, std::size_t end, std::vector<Node>& nodes) {
        const std::size_t index = nodes.size();
        nodes.push_back(makeNode(begin, end));
        if (end - begin <= m_run) return;
        const std::size_t middle = divide(begin, end);
        std::vector<Node> right;
        const auto addLeft = [&] { add(begin, middle, nodes); };
        const auto addRight = [&] { add(middle, end, right); };
        if (end - begin < kFewLights) {
            addLeft();
            nodes[index].right = static_cast<std::uint32_t>(nodes.size());
            add(middle, end, nodes);
            return;
        }
        tbb::parallel_invoke(addLeft, addRight);
        // Numbered from the tree's root, as if all had been added one after the other.
        const auto first = static_cast<std::uint32_t>(nodes.size());
        nodes[index].right = first;
        for (Node& node : right)
            if (node.right != 0) node.right += first;
        nodes.insert(nodes.end(), right.begin(), right.end());
    }

    Node makeNode(std::size_t begin, std::size_t end) const {
        const std::span<const std::uint32_t> lights(m_tree.m_order.data() + begin, end - begin);
        Vec3d lo = m_bounds[lights[0]].lo, hi = m_bounds[lights[0]].hi;
        Vec3f normals;
        bool anyDirection = false;
        double power = 0;
        for (const std::uint32_t light : lights) {
            goOn();
            const LightExtent& b = m_bounds[light];
            for (int axis = 0; axis < 3; ++axis) {
                lo[axis] = std::min(lo[axis], b.lo[axis]);
                hi[axis] = std::max(hi[axis], b.hi[axis]);
            }
            normals += b.axis;
            anyDirection |= b.anyDirection;
            power += m_tree.m_scene->lights()[light].powerMean;
        }
        Node node;
        LightBounds& bounds = node.bounds;
        bounds.centre = Vec3f((lo + hi) * 0.5);
        bounds.radius = static_cast<float>(0.5 * length(hi - lo));
        node.power = bounds.strength = static_cast<float>(power);
        node.begin = static_cast<std::uint32_t>(begin);
        if (!anyDirection && lengthSquared(normals) > 0.0f) {
            const Vec3f axis = normalize(normals);
            float cosSpread = 1.0f;
            for (const std::uint32_t light : lights)
                cosSpread = std::min(cosSpread, dot(axis, m_bounds[light].axis));
            cosSpread = std::max(0.0f, cosSpread);
            bounds.axis = axis * cosSpread;
            bounds.sinSpread = sineOf(cosSpread);
        }
        return node;
    }

    std::size_t divide(std::size_t begin, std::size_t end) {
        Vec3d lo = centre(m_tree.m_order[begin]), hi = lo;
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3d c = centre(m_tree.m_order[i]);
            for (int axis = 0; axis < 3; ++axis) {
                lo[axis] = std::min(lo[axis], c[axis]);
                hi[axis] = std::max(hi[axis], c[axis]);
            }
        }
        const Vec3d size = hi - lo;
        // Of sides that are alike the first, whatever rounding makes of them.
        int axis = 0;
        for (const int other : {1, 2})
            if (size[other] > (1 + kAlike) * size[axis]) axis = other;
        const auto first = m_tree.m_order.begin();
        const auto from = first + static_cast<std::ptrdiff_t>(begin);
        const auto to = first + static_cast<std::ptrdiff_t>(end);
        const double half = 0.5 * (lo[axis] + hi[axis]) + kAlike * size[axis];
        const auto inTheMiddle = std::stable_partition(
            from, to, [&](std::uint32_t light) { return centre(light)[axis] < half; });
        const auto middle = static_cast<std::size_t>(inTheMiddle - first);
        const std::size_t least = std::max<std::size_t>(1, (end - begin) / kLeastShare);
        if (middle - begin >= least && end - middle >= least) return middle;
        // Ties by index: one order, whatever the library's sort.
        std::sort(from, to, [&](std::uint32_t a, std::uint32_t b) {
            const double x = centre(a)[axis], y = centre(b)[axis];
            return x < y || (x == y && a < b);
        });
        return begin + (end - begin) / 2;
    }

    void sumUpLeaves() {
        m_tree.m_cumulative.resize(m_tree.m_order.size());
        for (std::uint32_t node = 0; node < m_tree.m_nodes.size(); ++node) {
            if (m_tree.m_nodes[node].right != 0) continue;
            const std::uint32_t begin = m_tree.m_nodes[node].begin, end = m_tree.end(node);
            const auto powerAt = [&](std::uint32_t at) {
                return m_tree.m_scene->lights()[m_tree.m_order[at]].powerMean;
            };
            double power = 0, sum = 0;
            for (std::uint32_t at = begin; at < end; ++at) power += powerAt(at);
            const double even = (power > 0 ? kEvenShare : 1.0) / (end - begin);
            for (std::uint32_t at = begin; at < end; ++at) {
                sum += even;
                if (power > 0) sum += (1.0 - kEvenShare) * powerAt(at) / power;
                m_tree.m_cumulative[at] = at + 1 == end ? 1.0f : static_cast<float>(sum);
            }
        }
    }

    LightTree& m_tree;
    const CancelCheck& m_cancel;
    std::vector<LightExtent> m_bounds;
    std::size_t m_run = 1;
};

LightTree::LightTree(const Scene& scene, const CancelCheck& cancel) : m_scene(&scene) {
    if (scene.nearLights().empty()) return;
    Builder(*this, cancel);
    makeQuads();
}

void LightTree::makeQuads() {
    m_quads.clear();
    m_entries.assign(m_nodes.size(), 0);
    std::uint32_t quads = 0;
    for (std::size_t i = 0; i < m_nodes.size(); ++i)
        m_entries[i] = m_nodes[i].right == 0 ? kLeaf | m_nodes[i].begin : quads++;
    m_quads.resize(quads);
    for (std::uint32_t i = 0; i < m_nodes.size(); ++i) {
        if (m_nodes[i].right == 0) continue;
        std::size_t group = 0;
        const auto add = [&](std::uint32_t node) {
            m_quads[m_entries[i]].set(group++, m_nodes[node].bounds, m_nodes[node].begin,
                                      m_entries[node]);
        };
        for (const std::uint32_t child : {i + 1, m_nodes[i].right}) {
            if (m_nodes[child].right == 0) {
                add(child);
            } else {
                add(child + 1);
                add(m_nodes[child].right);
            }
        }
    }
}

LightTree::Seen LightTree::sum(std::uint32_t node, std::span<const Seen> lights,
                               std::vector<Seen>& nodes) const {
    Seen total;
    const auto add = [&total](const Seen& part) {
        total.tried += part.tried;
        total.visible += part.visible;
    };
    const std::uint32_t right = m_nodes[node].right;
    if (right == 0) {
        for (std::uint32_t at = m_nodes[node].begin; at < end(node); ++at) add(lights[m_order[at]]);
    } else {
        add(sum(node + 1, lights, nodes));
        add(sum(right, lights, nodes));
    }
    return nodes[node] = total;
}

// What is known of the node above counts for a few sightings of this one. What a light that is
// visible by chance alone brings varies as the root of that chance, and so it should be chosen.
void LightTree::weaken(std::uint32_t node, float visibleAbove, std::span<const Seen> nodes) {
    const float visible = (nodes[node].visible + kPriorSightings * visibleAbove) /
                          (nodes[node].tried + kPriorSightings);
    const float atLeast = std::max(visible, kLeastVisible);
    m_nodes[node].bounds.strength = m_nodes[node].power * std::sqrt(atLeast);
    if (m_nodes[node].right == 0) {
        std::fill(m_visibility.begin() + m_nodes[node].begin, m_visibility.begin() + end(node),
                  atLeast);
        return;
    }
    weaken(node + 1, visible, nodes);
    weaken(m_nodes[node].right, visible, nodes);
}

void LightTree::learn(std::span<const Sighting> sightings) {
    if (m_nodes.empty()) return;
    std::vector<Seen> lights(m_order.size()), nodes(m_nodes.size());
    for (const Sighting& sighting : sightings) {
        lights[sighting.light].tried += 1.0f;
        lights[sighting.light].visible += sighting.visible ? 1.0f : 0.0f;
    }
    sum(kRoot, lights, nodes);
    weaken(kRoot, 0.5f, nodes);
    makeQuads();
}

float LightTree::importance(std::uint32_t node, const Receiver& receiver, int levels) const {
    const std::uint32_t right = m_nodes[node].right;
    if (levels == 0 || right == 0) {
        LightQuad quad;
        quad.set(0, m_nodes[node].bounds, 0, 0);
        return quad.importances(receiver)[0];
    }
    if (levels == 2) {
        const LightQuad::Four found = m_quads[m_entries[node]].importances(receiver);
        return (found[0] + found[1]) + (found[2] + found[3]);
    }
    return importance(node + 1, receiver, levels - 1) + importance(right, receiver, levels - 1);
}

std::uint32_t LightTree::end(std::uint32_t leaf) const {
    // The node after a leaf in the array begins where the leaf ends.
    return leaf + 1 < m_nodes.size() ? m_nodes[leaf + 1].begin
                                     : static_cast<std::uint32_t>(m_order.size());
}

void LightTree::choose(const Receiver& receiver, std::span<LightDescent> descents) const {
    for (LightDescent& descent : descents) {
        descent.node = m_entries[descent.node];
        prefetch(descent.node);
    }
    for (bool any = true; any;) {
        any = false;
        for (LightDescent& descent : descents) {
            if ((descent.node & kLeaf) != 0) continue;
            const LightQuad& quad = m_quads[descent.node];
            descent.node = quad.next[quad.choose(receiver, descent.u, descent.probability)];
            prefetch(descent.node);
            any = true;
        }
    }
    for (LightDescent& descent : descents) chooseInLeaf(descent);
}

// Whether it is a leaf or not no branch can foresee.
void LightTree::prefetch(std::uint32_t entry) const {
    const bool isLeaf = (entry & kLeaf) != 0;
    const void* const at = isLeaf ? static_cast<const void*>(&m_cumulative[entry & ~kLeaf])
                                  : static_cast<const void*>(&m_quads[entry]);
    __builtin_prefetch(at);
    __builtin_prefetch(static_cast<const char*>(at) + 64);
    __builtin_prefetch(static_cast<const char*>(at) + 128);
}

void LightTree::chooseInLeaf(LightDescent& descent) const {
    constexpr double kBelowOne = 1.0 - 0x1p-53;
    const double u = std::min(descent.u, kBelowOne);
    std::uint32_t at = descent.node & ~kLeaf;
    float below = 0.0f;
    for (; u >= static_cast<double>(m_cumulative[at]); ++at) below = m_cumulative[at];
    const float share = m_cumulative[at] - below;
    descent.node = m_order[at];
    descent.probability *= share;
    descent.u = std::min((u - static_cast<double>(below)) / static_cast<double>(share), kBelowOne);
}

float LightTree::probability(std::uint32_t node, const Receiver& receiver,
                             std::uint32_t light) const {
    const std::uint32_t position = m_positions[light];
    float product = 1.0f;
    std::uint32_t entry = m_entries[node];
    while ((entry & kLeaf) == 0) {
        const LightQuad& quad = m_quads[entry];
        const std::size_t group = quad.groupOf(position);
        product *= quad.share(receiver, group);
        entry = quad.next[group];
    }
    const bool isFirst = position == (entry & ~kLeaf);
    return product * (m_cumulative[position] - (isFirst ? 0.0f : m_cumulative[position - 1]));
}

std::vector<std::uint32_t> LightTree::cut(std::size_t most) const {
    std::vector<std::uint32_t> nodes;
    if (m_nodes.empty()) return nodes;
    nodes.push_back(kRoot);
    while (nodes.size() < most) {
        const auto worth = [&](std::uint32_t n) {
            const Node& node = m_nodes[n];
            return node.right == 0 ? -1.0f : node.bounds.strength * node.bounds.radius;
        };
        const auto widest =
            std::max_element(nodes.begin(), nodes.end(),
                             [&](std::uint32_t a, std::uint32_t b) { return worth(a) < worth(b); });
        if (worth(*widest) < 0.0f) break;
        const std::uint32_t right = m_nodes[*widest].right;
        *widest += 1;
        nodes.insert(widest + 1, right);
    }
    return nodes;
}

std::uint64_t LightTree::memoryBytes() const {
    return m_nodes.size() * (sizeof(Node) + sizeof(std::uint32_t)) +
           m_quads.size() * sizeof(LightQuad) +
           m_order.size() * (2 * sizeof(std::uint32_t) + 2 * sizeof(float));
}

}  // namespace pm
