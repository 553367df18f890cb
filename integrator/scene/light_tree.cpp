// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/scene/light_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

namespace pm {

namespace {

// With more lights than a processor's near memory has nodes for, a leaf holds a run of lights ...
constexpr std::size_t kMostSingle = 4096;
constexpr std::size_t kRun = 6;
// ... and a longer one with very many: nodes are no more than about twice this, some 8 MB.
constexpr std::size_t kMostLeaves = 1 << 16;
// A node is divided in the middle of its longest axis, unless one part then has less than this
// share of the lights: the tree stays shallow.
constexpr std::size_t kLeastShare = 8;
// Cosines count at least this: bounds are rounded, and shading normals lean.
constexpr float kLeastCosine = 0.02f;

// So many sightings is what is known of the node above worth; and no light counts as hidden more
// often than all but this.
constexpr float kPriorSightings = 2.0f;
constexpr float kLeastVisible = 0.01f;

// What one light contributes to the bounds of its nodes.
struct Bounds {
    Vec3d lo, hi;
    Vec3f axis;
    bool anyDirection = false;
};

Bounds boundsOf(const Scene& scene, const Light& light) {
    Bounds b;
    if (light.kind == Light::Kind::kTriangle) {
        b.lo = Vec3d(std::numeric_limits<double>::max());
        b.hi = -b.lo;
        for (const Vec2f corner : {Vec2f{0, 0}, Vec2f{1, 0}, Vec2f{1, 1}}) {
            const Surface surface = scene.pointOnLight(light, corner);
            const Vec3d p(surface.position);
            for (int axis = 0; axis < 3; ++axis) {
                b.lo[axis] = std::min(b.lo[axis], p[axis]);
                b.hi[axis] = std::max(b.hi[axis], p[axis]);
            }
            b.axis = surface.geometricNormal;
        }
        return b;
    }
    b.anyDirection = true;
    b.lo = b.hi = light.position;
    // A spot as a lamp that faces along its axis, where its cone is no wider than such a lamp's.
    if (light.kind == Light::Kind::kSpot && scene.beam(light).oneMinusCos <= 1.0f) {
        b.anyDirection = false;
        b.axis = scene.beam(light).axis;
    }
    if (light.kind == Light::Kind::kSphere) {
        const SphereShape sphere = scene.sphere(light.shape);
        b.lo = sphere.centre - Vec3d(sphere.radius);
        b.hi = sphere.centre + Vec3d(sphere.radius);
    }
    return b;
}

// Share of one light in the power of it and those after it, which `rest` becomes. Those get
// something however much `rest` was rounded.
float shareOfRest(float power, float& rest) {
    const float share = rest > 0.0f ? std::min(0.9999f, power / rest) : 0.5f;
    rest -= power;
    return share;
}

float sineOf(float cosine) {
    return std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
}

}  // namespace

class LightTree::Builder {
  public:
    explicit Builder(LightTree& tree) : m_tree(tree) {
        const std::span<const Light> lights = tree.m_scene->nearLights();
        for (const Light& light : lights) m_bounds.push_back(boundsOf(*tree.m_scene, light));
        if (lights.size() > kMostSingle)
            m_run = std::max(kRun, (lights.size() + kMostLeaves - 1) / kMostLeaves);
        tree.m_order.resize(lights.size());
        std::iota(tree.m_order.begin(), tree.m_order.end(), 0u);
        add(0, lights.size());
        tree.m_visibility.assign(lights.size(), 1.0f);
        tree.m_positions.resize(lights.size());
        for (std::uint32_t i = 0; i < lights.size(); ++i) tree.m_positions[tree.m_order[i]] = i;
    }

  private:
    Vec3d centre(std::uint32_t light) const {
        return (m_bounds[light].lo + m_bounds[light].hi) * 0.5;
    }

    void add(std::size_t begin, std::size_t end) {
        const std::size_t index = m_tree.m_nodes.size();
        m_tree.m_nodes.push_back(makeNode(begin, end));
        if (end - begin <= m_run) return;
        const std::size_t middle = divide(begin, end);
        add(begin, middle);
        m_tree.m_nodes[index].right = static_cast<std::uint32_t>(m_tree.m_nodes.size());
        add(middle, end);
    }

    Node makeNode(std::size_t begin, std::size_t end) const {
        const std::span<const std::uint32_t> lights(m_tree.m_order.data() + begin, end - begin);
        Vec3d lo = m_bounds[lights[0]].lo, hi = m_bounds[lights[0]].hi;
        Vec3f normals;
        bool anyDirection = false;
        double power = 0;
        for (const std::uint32_t light : lights) {
            const Bounds& b = m_bounds[light];
            for (int axis = 0; axis < 3; ++axis) {
                lo[axis] = std::min(lo[axis], b.lo[axis]);
                hi[axis] = std::max(hi[axis], b.hi[axis]);
            }
            normals += b.axis;
            anyDirection |= b.anyDirection;
            power += m_tree.m_scene->lights()[light].powerMean;
        }
        Node node{};
        node.centre = Vec3f((lo + hi) * 0.5);
        node.radius = static_cast<float>(0.5 * length(hi - lo));
        node.power = static_cast<float>(power);
        node.strength = node.power;
        node.begin = static_cast<std::uint32_t>(begin);
        node.cosSpread = 0.0f;
        node.sinSpread = 1.0f;
        if (!anyDirection && lengthSquared(normals) > 0.0f) {
            node.axis = normalize(normals);
            node.cosSpread = 1.0f;
            for (const std::uint32_t light : lights)
                node.cosSpread = std::min(node.cosSpread, dot(node.axis, m_bounds[light].axis));
            node.cosSpread = std::max(0.0f, node.cosSpread);
            node.sinSpread = sineOf(node.cosSpread);
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
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const auto first = m_tree.m_order.begin();
        const auto from = first + static_cast<std::ptrdiff_t>(begin);
        const auto to = first + static_cast<std::ptrdiff_t>(end);
        const double half = 0.5 * (lo[axis] + hi[axis]);
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

    LightTree& m_tree;
    std::vector<Bounds> m_bounds;
    std::size_t m_run = 1;
};

LightTree::LightTree(const Scene& scene) : m_scene(&scene) {
    if (!scene.nearLights().empty()) Builder(*this);
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
    m_nodes[node].strength = m_nodes[node].power * std::sqrt(atLeast);
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
}

// After [1], section 4, with simpler bounds of the cosines: of what may arrive from the ball's
// points, as if they were as far away as its centre.
float LightTree::importance(const Node& node, const Receiver& receiver) const {
    const Vec3f toCentre = node.centre - receiver.position;
    const float d2 = lengthSquared(toCentre), r2 = node.radius * node.radius;
    if (!(d2 > r2)) return node.strength / std::max(r2, std::numeric_limits<float>::min());
    const float d = std::sqrt(d2), inverse = 1.0f / d;
    const float in = (dot(receiver.normal, toCentre) + node.radius) * inverse;
    // cos(a - b) <= cos a cos b + sin b
    const float out =
        (node.radius - dot(node.axis, toCentre) * node.cosSpread) * inverse + node.sinSpread;
    return node.strength * std::clamp(in, kLeastCosine, 1.0f) *
           std::clamp(out, kLeastCosine, 1.0f) * (inverse * inverse);
}

float LightTree::importance(std::uint32_t node, const Receiver& receiver, int levels) const {
    const std::uint32_t right = m_nodes[node].right;
    if (levels == 0 || right == 0) return importance(m_nodes[node], receiver);
    return importance(node + 1, receiver, levels - 1) + importance(right, receiver, levels - 1);
}

float LightTree::leftProbability(std::uint32_t node, const Receiver& receiver) const {
    const float left = importance(m_nodes[node + 1], receiver);
    const float right = importance(m_nodes[m_nodes[node].right], receiver);
    const float share = left / (left + right);
    // Neither child is ever out of reach; the comparison is false for NaN.
    constexpr float kLeast = 1e-4f;
    return share >= kLeast ? std::min(share, 1.0f - kLeast) : share >= 0.0f ? kLeast : 0.5f;
}

std::uint32_t LightTree::end(std::uint32_t leaf) const {
    // The node after a leaf in the array begins where the leaf ends.
    return leaf + 1 < m_nodes.size() ? m_nodes[leaf + 1].begin
                                     : static_cast<std::uint32_t>(m_order.size());
}

float LightTree::powerAt(std::uint32_t position) const {
    return static_cast<float>(m_scene->lights()[m_order[position]].powerMean);
}

std::uint32_t LightTree::choose(std::uint32_t node, const Receiver& receiver, double& u,
                                float& probability) const {
    while (m_nodes[node].right != 0) {
        const float left = leftProbability(node, receiver);
        const bool goLeft = u < static_cast<double>(left);
        const float taken = goLeft ? left : 1.0f - left;
        u = (goLeft ? u : u - static_cast<double>(left)) / static_cast<double>(taken);
        probability *= taken;
        node = goLeft ? node + 1 : m_nodes[node].right;
    }
    std::uint32_t at = m_nodes[node].begin;
    const std::uint32_t last = end(node) - 1;
    for (float rest = m_nodes[node].power; at < last; ++at) {
        const float share = shareOfRest(powerAt(at), rest);
        const auto s = static_cast<double>(share);
        if (u < s) {
            probability *= share;
            u /= s;
            break;
        }
        probability *= 1.0f - share;
        u = (u - s) / (1.0 - s);
    }
    u = std::min(u, 1.0 - 0x1p-53);
    return m_order[at];
}

float LightTree::probability(std::uint32_t node, const Receiver& receiver,
                             std::uint32_t light) const {
    const std::uint32_t position = m_positions[light];
    float product = 1.0f;
    while (m_nodes[node].right != 0) {
        const float left = leftProbability(node, receiver);
        const std::uint32_t right = m_nodes[node].right;
        const bool goLeft = position < m_nodes[right].begin;
        product *= goLeft ? left : 1.0f - left;
        node = goLeft ? node + 1 : right;
    }
    const std::uint32_t last = end(node) - 1;
    float rest = m_nodes[node].power;
    for (std::uint32_t at = m_nodes[node].begin; at < last; ++at) {
        const float share = shareOfRest(powerAt(at), rest);
        if (at == position) return product * share;
        product *= 1.0f - share;
    }
    return product;
}

std::vector<std::uint32_t> LightTree::cut(std::size_t most) const {
    std::vector<std::uint32_t> nodes;
    if (m_nodes.empty()) return nodes;
    nodes.push_back(kRoot);
    while (nodes.size() < most) {
        const auto worth = [&](std::uint32_t n) {
            const Node& node = m_nodes[n];
            return node.right == 0 ? -1.0f : node.strength * node.radius;
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
    return m_nodes.size() * sizeof(Node) +
           m_order.size() * (2 * sizeof(std::uint32_t) + sizeof(float));
}

}  // namespace pm
