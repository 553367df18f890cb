// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "integrator/light_sampling/light_quad.h"
#include "integrator/scene/scene.h"
#include "integrator/values/cancel_check.h"
#include "integrator/values/vec.h"

namespace pm {

// What was found between a place and a point on a light that could shine on it.
struct Sighting {
    std::uint32_t light = 0;
    bool visible = false;
};

// The choice of a light, on its way.
struct LightDescent {
    double u = 0.0;          // random number in [0, 1); then where in the light's share it lay
    std::uint32_t node = 0;  // of the tree, below which to choose; then the light
    float probability = 1.0f;
};

// A binary tree over the lights by place; those that are infinitely far are not in it. A light is
// chosen by going down it two levels at a time, towards one of four grandchildren in proportion to
// what may arrive from there, if nothing is in between, and to how often something is. The lights'
// order in the tree is a curve through space: neighbours in it are neighbours in space.
// Threads: const functions from any, at once.
class LightTree {
  public:
    LightTree() = default;
    // Builds in parallel in the calling TBB arena; the same tree for any number of threads. Throws
    // Error(kCancelled) soon after cancel is set.
    explicit LightTree(const Scene& scene, const CancelCheck& cancel = {});

    static constexpr std::uint32_t kRoot = 0;

    // Learns which lights are hidden from most places: lamps in closed boxes, of rooms next door.
    void learn(std::span<const Sighting> sightings);

    // Chooses a light for each of the descents, on its own; multiplies the light's probability into
    // theirs. Side by side, since one waits for memory and divisions most of the time.
    void choose(const Receiver& receiver, std::span<LightDescent> descents) const;
    // The probability with which choose() below `node` takes `light`, which must be there.
    float probability(std::uint32_t node, const Receiver& receiver, std::uint32_t light) const;

    // What may arrive from a node's lights, summed over what is `levels` below it: by that a choice
    // between nodes should go. W over scene units squared, times a constant.
    float importance(std::uint32_t node, const Receiver& receiver, int levels) const;
    // Share of the sightings of a light in which it was visible, as far as is known.
    float visibility(std::uint32_t light) const { return m_visibility[m_positions[light]]; }

    // Up to `most` nodes, in the order of the tree, that hold every light once: those with much
    // power spread widely are divided first.
    std::vector<std::uint32_t> cut(std::size_t most) const;

    // Place of a light in the tree's order, and where in it a node's lights begin.
    std::uint32_t position(std::uint32_t light) const { return m_positions[light]; }
    std::uint32_t begin(std::uint32_t node) const { return m_nodes[node].begin; }
    // Of all the lights below, W.
    float power(std::uint32_t node) const { return m_nodes[node].power; }

    std::uint64_t memoryBytes() const;

  private:
    struct Node {
        LightBounds bounds;
        float power = 0.0f;       // W
        std::uint32_t begin = 0;  // first light in the tree's order
        std::uint32_t right = 0;  // the left child follows its parent; 0: no children
    };
    class Builder;
    // What was seen of the lights below a node.
    struct Seen {
        float tried = 0.0f, visible = 0.0f;
    };
    Seen sum(std::uint32_t node, std::span<const Seen> lights, std::vector<Seen>& nodes) const;
    void weaken(std::uint32_t node, float visibleAbove, std::span<const Seen> nodes);

    void makeQuads();
    std::uint32_t end(std::uint32_t leaf) const;
    void prefetch(std::uint32_t entry) const;
    void chooseInLeaf(LightDescent& descent) const;

    const Scene* m_scene = nullptr;
    std::vector<Node> m_nodes;
    std::vector<LightQuad> m_quads;  // the grandchildren of each node that has children
    // Of the nodes: the number of its quad; of a leaf kLeaf and the place of its first light.
    std::vector<std::uint32_t> m_entries;
    static constexpr std::uint32_t kLeaf = 1u << 31;
    std::vector<std::uint32_t> m_order;      // lights
    std::vector<std::uint32_t> m_positions;  // of the lights in m_order
    // In that order, within each leaf: shares by power, summed up; the last is 1.
    std::vector<float> m_cumulative;
    std::vector<float> m_visibility;  // in that order
};

}  // namespace pm
