// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "integrator/scene/scene.h"
#include "integrator/values/vec.h"

namespace pm {

// Where light is asked for: a point, and the shading normal on the side that is lit; unit, scene's
// own coordinates.
struct Receiver {
    Vec3f position;
    Vec3f normal;
};

// What was found between a place and a point on a light that could shine on it.
struct Sighting {
    std::uint32_t light = 0;
    bool visible = false;
};

// A binary tree over the lights by place; those that are infinitely far are not in it. A light is
// chosen by going down it, at each node towards a child in proportion to what may arrive from
// there, if nothing is in between, and to how often something is. The lights' order in the tree is
// a curve through space: neighbours in it are neighbours in space. [1] Conty Estevez & Kulla,
// "Importance Sampling of Many Lights with Adaptive Tree Splitting", 2018. Threads: const functions
// from any, at once.
class LightTree {
  public:
    LightTree() = default;
    explicit LightTree(const Scene& scene);

    static constexpr std::uint32_t kRoot = 0;

    // Learns which lights are hidden from most places: lamps in closed boxes, of rooms next door.
    void learn(std::span<const Sighting> sightings);

    // Chooses below `node`. Returns the light; multiplies its probability into `probability`; u, in
    // [0, 1), becomes where in the light's share it lay.
    std::uint32_t choose(std::uint32_t node, const Receiver& receiver, double& u,
                         float& probability) const;
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
        Vec3f centre;  // of a ball that holds the lights
        float radius;
        Vec3f axis;       // of a cone that holds their normals
        float cosSpread;  // of the cone's half angle; 0 and more than a right angle are the same
        float sinSpread;
        float power;          // W
        float strength;       // power, less where the lights are mostly hidden
        std::uint32_t begin;  // first light in the tree's order
        std::uint32_t right;  // the left child follows its parent; 0: no children
    };
    class Builder;
    // What was seen of the lights below a node.
    struct Seen {
        float tried = 0.0f, visible = 0.0f;
    };
    Seen sum(std::uint32_t node, std::span<const Seen> lights, std::vector<Seen>& nodes) const;
    void weaken(std::uint32_t node, float visibleAbove, std::span<const Seen> nodes);

    float importance(const Node& node, const Receiver& receiver) const;
    float leftProbability(std::uint32_t node, const Receiver& receiver) const;
    std::uint32_t end(std::uint32_t leaf) const;
    float powerAt(std::uint32_t position) const;

    const Scene* m_scene = nullptr;
    std::vector<Node> m_nodes;
    std::vector<std::uint32_t> m_order;      // lights
    std::vector<std::uint32_t> m_positions;  // of the lights in m_order
    std::vector<float> m_visibility;         // in that order
};

}  // namespace pm
