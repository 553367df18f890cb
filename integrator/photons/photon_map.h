// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "integrator/photons/photon.h"
#include "integrator/photons/photon_leaf.h"
#include "integrator/photons/photon_tree.h"
#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

// The same quantity estimated at a radius and at that over sqrt(2): its bias grows with the radius
// squared, so that about half of it is gone in the narrower one, and the difference measures it.
struct TwoRadii {
    Rgb wide, narrow;

    TwoRadii& operator+=(const TwoRadii& o) {
        wide += o.wide;
        narrow += o.narrow;
        return *this;
    }
};

// The k photons found for a point, with the working memory of a query; one for each thread. What is
// found never depends on earlier queries; how fast does: a query near the last one is faster.
class NearestPhotons {
  public:
    struct Found {
        float distanceSquared;
        std::uint32_t index;
        // Nearer first; of equals the lower index, so that the set found never depends on the order
        // of the search.
        friend bool operator<(const Found& a, const Found& b) {
            return a.distanceSquared < b.distanceSquared ||
                   (a.distanceSquared == b.distanceSquared && a.index < b.index);
        }
    };
    // In no particular order, unless as many were found as asked for: then the farthest is first.
    const std::vector<Found>& found() const { return m_found; }

  private:
    friend class PhotonMap;
    std::vector<Found> m_found;
    std::vector<std::uint64_t> m_keys;  // PhotonMap::keyOf
    // The last query that found as many as it asked for.
    const void* m_lastMap = nullptr;
    Vec3f m_lastPosition;
    std::uint32_t m_lastCount = 0;
    float m_lastReach = 0.0f;  // squared distance of its farthest
};

// What a query looks for.
struct PhotonQuery {
    Vec3f position;
    Vec3f normal;                  // unit, on the side whose photons count
    std::uint32_t count = 50;      // k
    float maxRadius = 0.0f;        // scene units
    std::uint32_t leaveOut = ~0u;  // index of a photon not to be found: the one a query stands on
};

// Photons of one kind and pass, and the look-ups that estimates are made of.
// Threads: all const functions from any, at once.
class PhotonMap {
  public:
    // Builds in parallel in the calling TBB arena. Photons whose position is not finite must not be
    // among them. They are copied.
    // Throws Error(kCancelled) soon after cancel is set.
    explicit PhotonMap(std::span<const Photon> photons, const CancelCheck& cancel = {});

    // While it is built, the photons that it is built from included.
    static constexpr std::uint64_t kBytesPerPhoton = sizeof(Photon) + kTreeBuildBytesPerPhoton;

    bool empty() const { return m_tree.size == 0; }
    std::size_t size() const { return m_tree.size; }
    // index: of the photon in the map, below size(); not that of the photons it was built from.
    Photon photon(std::uint32_t index) const {
        const PhotonLeaf& leaf = m_tree.leaves[index / PhotonLeaf::kSize];
        const std::uint32_t i = index % PhotonLeaf::kSize;
        const float* const flux = &m_tree.fluxes[std::size_t{3} * index];
        return {leaf.position(i), {flux[0], flux[1], flux[2]}, leaf.normal(i)};
    }
    std::uint64_t memoryBytes() const;

    // Finds the query.count nearest accepted photons within query.maxRadius: those of the side the
    // normal points to, of about the same normal, near the plane through the point. Ties go to the
    // lower index.
    void findNearest(const PhotonQuery& query, NearestPhotons& nearest) const;

    // The flux, W, of the accepted photons within radius and, of those, the ones within
    // radius/sqrt(2): over pi radius^2, or half of it, it is irradiance, without bias where that is
    // constant and the surface fills the disc, however the photons are spread. (An estimate from
    // the k nearest is unbiased for independent photons alone; these are stratified.) Summed in
    // double in the order of the tree.
    TwoRadii fluxWithin(const Vec3f& position, const Vec3f& normal, float radius) const {
        return fluxWithin(position, normal, radius, [](std::uint32_t) { return true; });
    }
    // accept(index): whether the photon of this index counts, too.
    template <typename Accept>
    TwoRadii fluxWithin(const Vec3f& position, const Vec3f& normal, float radius,
                        const Accept& accept) const;

    // The radius within which half of the photons find count others; of fewer photons, the size of
    // what they cover. Scene units, > 0.
    float typicalRadius(std::uint32_t count) const;

    // Which photons count for a point, distance aside.
    PhotonGate gate(const Vec3f& position, const Vec3f& normal) const {
        return {position, normal, m_planeToleranceSquared};
    }

  private:
    float firstReach(const PhotonQuery& query, const NearestPhotons& nearest) const;
    std::uint32_t leafOf(const Vec3f& position) const;
    struct FluxSum {
        double r = 0, g = 0, b = 0;

        FluxSum& operator+=(const FluxSum& o) {
            r += o.r;
            g += o.g;
            b += o.b;
            return *this;
        }
        Rgb rgb() const {
            return {static_cast<float>(r), static_cast<float>(g), static_cast<float>(b)};
        }
    };
    template <typename Accept>
    FluxSum sumOf(std::uint32_t leaf, std::uint32_t which, const Accept& accept) const;
    void findWithin(const PhotonQuery& query, float reach, NearestPhotons& nearest) const;
    // The order of Found as a number: the distance's bits, which rise as it does, over the index.
    static std::uint64_t keyOf(float distanceSquared, std::uint32_t index) {
        return std::uint64_t{std::bit_cast<std::uint32_t>(distanceSquared)} << 32 | index;
    }
    static float distanceSquaredOf(std::uint64_t key) {
        return std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32));
    }
    // Calls visit(number) for every leaf where a photon may have a key up to `last` (which may fall
    // meanwhile), nearer halves first.
    template <typename Visit>
    void visitLeaves(const Vec3f& position, const std::uint64_t& last, const Visit& visit) const;

    PhotonTree m_tree;
    float m_planeToleranceSquared = 0.0f;
};

template <typename Visit>
void PhotonMap::visitLeaves(const Vec3f& position, const std::uint64_t& last,
                            const Visit& visit) const {
    // Part of the tree, and the way to it from the point along each axis: never longer than the way
    // to a photon there, rounding included.
    struct Part {
        std::uint32_t node, firstLeaf, leafCount;
        Vec3f away;
        std::uint64_t leastKey;
    };
    if (m_tree.leafCount == 0) return;
    std::array<Part, 32> stack;
    std::size_t depth = 0;
    stack[depth++] = {0, 0, m_tree.leafCount, {}, 0};
    while (depth > 0) {
        Part at = stack[--depth];
        if (at.leastKey > last) continue;
        while (at.leafCount > 1) {
            const PhotonTree::Node& node = m_tree.nodes[at.node];
            const auto axis = static_cast<int>(node.axis);
            const float side = position[axis] - node.split;
            const std::uint32_t leftLeaves = PhotonTree::leftLeaves(at.leafCount);
            // Left also where all coincide: the lowest indices are there.
            const bool nearIsLeft = side <= 0.0f;
            Part far = at;
            far.away[axis] = side;
            far.node = 2 * at.node + (nearIsLeft ? 2 : 1);
            at.node = 2 * at.node + (nearIsLeft ? 1 : 2);
            const std::uint32_t rightFirst = at.firstLeaf + leftLeaves;
            far.firstLeaf = nearIsLeft ? rightFirst : at.firstLeaf;
            at.firstLeaf = nearIsLeft ? at.firstLeaf : rightFirst;
            const std::uint32_t rightLeaves = at.leafCount - leftLeaves;
            far.leafCount = nearIsLeft ? rightLeaves : leftLeaves;
            at.leafCount = nearIsLeft ? leftLeaves : rightLeaves;
            far.leastKey = keyOf(lengthSquared(far.away), far.firstLeaf * PhotonLeaf::kSize);
            if (far.leastKey > last) continue;
            stack[depth++] = far;
            if (far.leafCount == 1) m_tree.leaves[far.firstLeaf].prefetch();
        }
        visit(at.firstLeaf);
    }
}

// The flux of the photons of a leaf whose bits are set.
template <typename Accept>
PhotonMap::FluxSum PhotonMap::sumOf(std::uint32_t leaf, std::uint32_t which,
                                    const Accept& accept) const {
    FluxSum sum;
    for (; which != 0; which &= which - 1) {
        const std::uint32_t index =
            leaf * PhotonLeaf::kSize + static_cast<std::uint32_t>(std::countr_zero(which));
        if (!accept(index)) continue;
        const float* const flux = &m_tree.fluxes[std::size_t{3} * index];
        sum += {static_cast<double>(flux[0]), static_cast<double>(flux[1]),
                static_cast<double>(flux[2])};
    }
    return sum;
}

template <typename Accept>
TwoRadii PhotonMap::fluxWithin(const Vec3f& position, const Vec3f& normal, float radius,
                               const Accept& accept) const {
    FluxSum narrow, ring;
    const float reach = radius * radius;
    const PhotonGate gate = this->gate(position, normal);
    visitLeaves(position, keyOf(reach, ~0u), [&](std::uint32_t leaf) {
        std::array<float, PhotonLeaf::kSize> distances;
        const std::uint32_t found = m_tree.leaves[leaf].findWithin(gate, reach, distances.data());
        if (found == 0) return;
        const std::uint32_t inNarrow = PhotonLeaf::compare(distances.data(), 0.5f * reach);
        narrow += sumOf(leaf, found & inNarrow, accept);
        ring += sumOf(leaf, found & ~inNarrow, accept);
    });
    ring += narrow;
    return {ring.rgb(), narrow.rgb()};
}

}  // namespace pm
