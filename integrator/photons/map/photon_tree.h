// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <bit>
#include <cstdint>
#include <memory>
#include <span>

#include "integrator/photons/map/big_array.h"
#include "integrator/photons/map/photon.h"
#include "integrator/photons/map/photon_leaf.h"
#include "integrator/photons/map/photon_pages.h"
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
    // Or of a tree that is not in memory, both.
    std::unique_ptr<PhotonPages> pages;
};

// A tree's leaves as one query reads them, one at a time; keeps the page that it read last. What is
// returned is valid until the next leaf is asked for. Errors: those of PhotonPages::page.
class LeafReader {
  public:
    explicit LeafReader(const PhotonTree& tree) : m_tree(tree) {}

    const PhotonLeaf& places(std::uint32_t leaf) {
        return m_tree.pages ? paged(leaf).places : m_tree.leaves[leaf];
    }
    const LeafFluxes& fluxes(std::uint32_t leaf) {
        return m_tree.pages ? paged(leaf).fluxes : m_tree.fluxes[leaf];
    }

  private:
    const PagedLeaf& paged(std::uint32_t leaf) {
        const std::uint32_t number = leaf / PhotonPages::kLeavesPerPage;
        if (!m_page || number != m_number) {
            m_page = {};  // before the next is pinned
            m_page = m_tree.pages->page(number);
            m_number = number;
        }
        return (*m_page)[leaf % PhotonPages::kLeavesPerPage];
    }

    const PhotonTree& m_tree;
    PhotonPages::Pin m_page;
    std::uint32_t m_number = 0;
};

// In parallel in the calling TBB arena; the same photons give the same tree for any number of
// threads. Positions must be finite; at most 2^32 - 1 photons. Throws Error(kCancelled) soon after
// cancel is set.
PhotonTree buildPhotonTree(std::span<const Photon> photons, const CancelCheck& cancel = {});

constexpr std::uint64_t kTreeBytesPerPhoton = 29;
// While it is built, beside the photons: two lists of entries, their buckets, and the tree itself.
constexpr std::uint64_t kTreeBuildBytesPerPhoton = 2 * 16 + 1 + kTreeBytesPerPhoton;
// Of that the lists and buckets of so many photons.
std::uint64_t treeBuildBytes(std::uint64_t photons);

}  // namespace pm
