// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <bit>
#include <cstdint>
#include <span>

#include "integrator/photons/map/big_array.h"
#include "integrator/photons/map/photon.h"
#include "integrator/photons/map/photon_leaf.h"
#include "integrator/values/cancel_check.h"

namespace pm {

// Photons in a balanced, pointer-free kd-tree: nodes in an implicit heap (children of i at 2i+1 and
// 2i+2), the first halves of whose leaves lie left; all leaves but the last are full.
// Source: Jensen 2001, section 6.1.
struct PhotonTree {
    struct Node {
        float split;
        std::uint32_t axis;
    };

    static std::uint32_t leftLeaves(std::uint32_t leaves) { return (leaves + 1) / 2; }

    std::uint32_t nodeCount() const { return leafCount > 0 ? std::bit_ceil(leafCount) - 1 : 0; }

    std::size_t size = 0;  // photons
    Vec3f lo, hi;          // their box, scene units
    std::uint32_t leafCount = 0;
    // Arrays that nothing is written to before the threads that build them do.
    BigArray<Node> nodes;
    BigArray<PhotonLeaf> leaves;
    BigArray<LeafFluxes> fluxes;  // of each leaf
};

// In parallel in the calling TBB arena; the same photons give the same tree for any number of
// threads. Positions must be finite; at most 2^32 - 1 photons. Throws Error(kCancelled) soon after
// cancel is set.
PhotonTree buildPhotonTree(std::span<const Photon> photons, const CancelCheck& cancel = {});

constexpr std::uint64_t kTreeBytesPerPhoton = 29;
// While it is built, beside the photons: two lists of entries, their buckets, and the tree itself.
constexpr std::uint64_t kTreeBuildBytesPerPhoton = 2 * 16 + 1 + kTreeBytesPerPhoton;

}  // namespace pm
