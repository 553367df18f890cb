// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "integrator/photons/map/photon.h"
#include "integrator/photons/map/photon_leaf.h"
#include "integrator/photons/map/photon_spool.h"
#include "integrator/photons/map/photon_tree.h"
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

// The k photons found for a point, with the working memory of queries; one for each thread. What is
// found never depends on earlier queries; how fast does: a query near the last one is faster.
class NearestPhotons {
  public:
    NearestPhotons() = default;

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

    // The leaves of a map where a photon may lie within a ball, in the order of their numbers:
    // while queries stay inside it, there is no need to look for them again.
    struct Leaves {
        std::shared_ptr<const int> map;  // held, so that no later map can have the same
        Vec3f centre;
        float radius = 0.0f;
        std::uint32_t count = 0;
        std::array<std::uint32_t, 64> numbers;
    };
    std::array<Leaves, 2> m_leaves;  // of the maps asked last: a pilot's and a pass's
    std::uint32_t m_newestLeaves = 0;
    // The last query of PhotonMap::radiusOf that found as many as it asked for.
    struct Radius {
        Vec3f position, normal;
        std::uint32_t count = 0;
        float radius = 0.0f;
        const int* map = nullptr;  // one that m_leaves holds
    };
    Radius m_lastRadius;
    std::vector<float> m_distances;
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
    // coreRadius: of a scene of which some lies far beyond it (Scene::hasCore()): places within it
    // are not rounded as those there are. Scene units.
    explicit PhotonMap(std::span<const Photon> photons, const CancelCheck& cancel = {},
                       float coreRadius = std::numeric_limits<float>::infinity());
    // The same map, with its photons in pages that are read when they are asked for; all its
    // functions then throw what reading a file may throw. As buildPagedTree.
    PhotonMap(std::unique_ptr<PhotonSpool> photons, PhotonPaging& paging,
              const CancelCheck& cancel = {},
              float coreRadius = std::numeric_limits<float>::infinity());

    // While it is built, the photons that it is built from included; and once it is.
    static constexpr std::uint64_t kBytesPerPhoton = sizeof(Photon) + kTreeBuildBytesPerPhoton;
    static constexpr std::uint64_t kHeldBytesPerPhoton = kTreeBytesPerPhoton;
    // In pages, without those: the planes of the tree.
    static constexpr std::uint64_t kPagedBytesPerPhoton = 1;

    bool empty() const { return m_tree.size == 0; }
    std::size_t size() const { return m_tree.size; }
    // index: of the photon in the map, below size(); not that of the photons it was built from.
    Photon photon(std::uint32_t index) const {
        LeafReader reader(m_tree);
        const std::uint32_t leaf = index / PhotonLeaf::kSize, i = index % PhotonLeaf::kSize;
        const PhotonLeaf& places = reader.places(leaf);
        return {places.position(i), reader.fluxes(leaf).at(i), places.normal(i)};
    }
    // Without pages: those are PhotonPaging's.
    std::uint64_t memoryBytes() const;
    bool isPaged() const { return m_tree.pages != nullptr; }

    // Finds the query.count nearest accepted photons within query.maxRadius: those of the side the
    // normal points to, of about the same normal, near the plane through the point. Ties go to the
    // lower index.
    void findNearest(const PhotonQuery& query, NearestPhotons& nearest) const;
    // The distance of the farthest of those, scene units; infinite where fewer are found.
    float radiusOf(const PhotonQuery& query, NearestPhotons& nearest) const;

    // The flux, W, of the accepted photons within radius and, of those, the ones within
    // radius/sqrt(2): over pi radius^2, or half of it, it is irradiance, without bias where that is
    // constant and the surface fills the disc, however the photons are spread. (An estimate from
    // the k nearest is unbiased for independent photons alone; these are stratified.) Summed in
    // double over the leaves, in the order of the tree.
    TwoRadii fluxWithin(const Vec3f& position, const Vec3f& normal, float radius) const;
    // The same bits; faster near the last query by the same `nearest`.
    TwoRadii fluxWithin(const Vec3f& position, const Vec3f& normal, float radius,
                        NearestPhotons& nearest) const;
    // Of photons in the point's plane alone, to rounding.
    TwoRadii fluxInPlane(const Vec3f& position, const Vec3f& normal, float radius) const;
    // accept(index): whether the photon of this index counts, too.
    template <typename Accept>
    TwoRadii fluxWithin(const Vec3f& position, const Vec3f& normal, float radius,
                        const Accept& accept) const;

    // Calls visit(index, squared distance) for every accepted photon within radius, in the order of
    // the tree; faster near the last query by the same `nearest`.
    template <typename Visit>
    void visitAccepted(const Vec3f& position, const Vec3f& normal, float radius,
                       NearestPhotons& nearest, const Visit& visit) const;

    // The radius within which half of the photons find count others; of fewer photons, the size of
    // what they cover. Scene units, > 0.
    float typicalRadius(std::uint32_t count) const;

    // Which photons count for a point, distance aside.
    PhotonGate gate(const Vec3f& position, const Vec3f& normal) const {
        const float largest = std::max(m_coreRadius, maxAbsComponent(position));
        if (!(largest < m_largest)) return {position, normal, m_planeToleranceSquared};
        const float tolerance = PhotonGate::kRounding * largest;
        return {position, normal, tolerance * tolerance};
    }

  private:
    PhotonMap(PhotonTree tree, float coreRadius);
    static TwoRadii radiiOf(const FluxSums& sums) {
        const auto rgb = [](const std::array<double, 3>& c) {
            return Rgb(static_cast<float>(c[0]), static_cast<float>(c[1]),
                       static_cast<float>(c[2]));
        };
        return {rgb(sums.wide), rgb(sums.narrow)};
    }
    TwoRadii fluxWithin(const PhotonGate& gate, float radius) const;
    const NearestPhotons::Leaves* leavesAround(const Vec3f& position, float radius,
                                               NearestPhotons& nearest) const;
    std::size_t findDistances(const PhotonQuery& query, float reach,
                              const NearestPhotons::Leaves& leaves,
                              std::vector<float>& distances) const;
    float boundOf(const PhotonQuery& query, const NearestPhotons& nearest) const;
    float firstReach(const PhotonQuery& query, const NearestPhotons& nearest) const;
    std::uint32_t leafOf(const Vec3f& position) const;
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

    // Calls visit(number) for every leaf where a photon may lie within reach (squared), in the
    // order of their numbers.
    template <typename Visit>
    void visitWithin(const Vec3f& position, float reach, const Visit& visit) const;

    PhotonTree m_tree;
    float m_coreRadius, m_largest = 0.0f;  // the largest coordinate of a photon
    float m_planeToleranceSquared = 0.0f;
    std::shared_ptr<const int> m_identity = std::make_shared<const int>(0);
};

// The way from a point to a part of space, along each axis.
class Away {
  public:
#if defined(__SSE2__)
    Away with(std::uint32_t axis, float side) const {
        alignas(16) static constexpr std::array<std::array<std::uint32_t, 4>, 3> kMasks = {
            {{~0u, 0, 0, 0}, {0, ~0u, 0, 0}, {0, 0, ~0u, 0}}};
        const __m128 mask =
            _mm_castsi128_ps(_mm_load_si128(reinterpret_cast<const __m128i*>(kMasks[axis].data())));
        Away changed;
        changed.m_way = _mm_or_ps(_mm_andnot_ps(mask, m_way), _mm_and_ps(mask, _mm_set1_ps(side)));
        return changed;
    }
    float lengthSquared() const {
        const __m128 s = _mm_mul_ps(m_way, m_way);
        const __m128 xy = _mm_add_ss(s, _mm_shuffle_ps(s, s, 1));
        return _mm_cvtss_f32(_mm_add_ss(xy, _mm_movehl_ps(s, s)));
    }

  private:
    __m128 m_way = _mm_setzero_ps();
#else
    Away with(std::uint32_t axis, float side) const {
        Away changed = *this;
        changed.m_way[axis] = side;
        return changed;
    }
    float lengthSquared() const {
        return m_way[0] * m_way[0] + m_way[1] * m_way[1] + m_way[2] * m_way[2];
    }

  private:
    std::array<float, 3> m_way{};
#endif
};

template <typename Visit>
void PhotonMap::visitLeaves(const Vec3f& position, const std::uint64_t& last,
                            const Visit& visit) const {
    // Part of the tree, and the way to it from the point along each axis: never longer than the way
    // to a photon there, rounding included.
    struct Part {
        Away away;
        std::uint32_t node, firstLeaf, leafCount;
        std::uint64_t leastKey;
    };
    if (m_tree.leafCount == 0) return;
    const std::array<float, 3> from = {position.x, position.y, position.z};
    std::array<Part, 32> stack;
    std::size_t depth = 0;
    stack[depth++] = {{}, 0, 0, m_tree.leafCount, 0};
    while (depth > 0) {
        Part at = stack[--depth];
        if (at.leastKey > last) continue;
        while (at.leafCount > 1) {
            const PhotonTree::Node& node = m_tree.nodes[at.node];
            const float side = from[node.axis] - node.split;
            const std::uint32_t leftLeaves = PhotonTree::leftLeaves(at.leafCount);
            // Left also where all coincide: the lowest indices are there.
            const bool nearIsLeft = side <= 0.0f;
            Part far = at;
            far.away = at.away.with(node.axis, side);
            far.node = 2 * at.node + (nearIsLeft ? 2 : 1);
            at.node = 2 * at.node + (nearIsLeft ? 1 : 2);
            const std::uint32_t rightFirst = at.firstLeaf + leftLeaves;
            far.firstLeaf = nearIsLeft ? rightFirst : at.firstLeaf;
            at.firstLeaf = nearIsLeft ? at.firstLeaf : rightFirst;
            const std::uint32_t rightLeaves = at.leafCount - leftLeaves;
            far.leafCount = nearIsLeft ? rightLeaves : leftLeaves;
            at.leafCount = nearIsLeft ? leftLeaves : rightLeaves;
            far.leastKey = keyOf(far.away.lengthSquared(), far.firstLeaf * PhotonLeaf::kSize);
            if (far.leastKey > last) continue;
            stack[depth++] = far;
            if (far.leafCount == 1 && m_tree.leaves) m_tree.leaves[far.firstLeaf].prefetch();
        }
        visit(at.firstLeaf);
    }
}

template <typename Visit>
void PhotonMap::visitWithin(const Vec3f& position, float reach, const Visit& visit) const {
    // As in visitLeaves.
    struct Part {
        Away away;
        std::uint32_t node, firstLeaf, leafCount;
    };
    if (m_tree.leafCount == 0) return;
    const std::array<float, 3> from = {position.x, position.y, position.z};
    std::array<Part, 32> stack;
    std::size_t depth = 0;
    stack[depth++] = {{}, 0, 0, m_tree.leafCount};
    while (depth > 0) {
        Part at = stack[--depth];
        while (at.leafCount > 1) {
            const PhotonTree::Node& node = m_tree.nodes[at.node];
            const float side = from[node.axis] - node.split;
            const std::uint32_t leftLeaves = PhotonTree::leftLeaves(at.leafCount);
            const bool nearIsLeft = side <= 0.0f;
            const Away away = at.away.with(node.axis, side);
            const bool reachesFar = away.lengthSquared() <= reach;
            const Part left{nearIsLeft ? at.away : away, 2 * at.node + 1, at.firstLeaf, leftLeaves};
            const Part right{nearIsLeft ? away : at.away, 2 * at.node + 2,
                             at.firstLeaf + leftLeaves, at.leafCount - leftLeaves};
            if (reachesFar) stack[depth++] = right;
            at = reachesFar || nearIsLeft ? left : right;
        }
        visit(at.firstLeaf);
    }
}

template <typename Accept>
TwoRadii PhotonMap::fluxWithin(const Vec3f& position, const Vec3f& normal, float radius,
                               const Accept& accept) const {
    FluxSums sums;
    const float reach = radius * radius;
    const PhotonGate gate = this->gate(position, normal);
    LeafReader reader(m_tree);
    visitWithin(position, reach, [&](std::uint32_t leaf) {
        std::array<float, PhotonLeaf::kSize> distances;
        std::uint32_t found = reader.places(leaf).findWithin(gate, reach, distances.data());
        for (std::uint32_t left = found; left != 0; left &= left - 1)
            if (!accept(leaf * PhotonLeaf::kSize +
                        static_cast<std::uint32_t>(std::countr_zero(left))))
                found &= ~(left & -left);
        if (found == 0) return;
        const std::uint32_t narrow = found & PhotonLeaf::compare(distances.data(), 0.5f * reach);
        reader.fluxes(leaf).add(found, narrow, sums);
    });
    return radiiOf(sums);
}

template <typename Visit>
void PhotonMap::visitAccepted(const Vec3f& position, const Vec3f& normal, float radius,
                              NearestPhotons& nearest, const Visit& visit) const {
    const float reach = radius * radius;
    const PhotonGate gate = this->gate(position, normal);
    LeafReader reader(m_tree);
    const auto visitLeaf = [&](std::uint32_t leaf) {
        std::array<float, PhotonLeaf::kSize> distances;
        std::uint32_t found = reader.places(leaf).findWithin(gate, reach, distances.data());
        for (; found != 0; found &= found - 1) {
            const auto i = static_cast<std::uint32_t>(std::countr_zero(found));
            visit(leaf * PhotonLeaf::kSize + i, distances[i]);
        }
    };
    if (const NearestPhotons::Leaves* const leaves = leavesAround(position, radius, nearest))
        std::for_each_n(leaves->numbers.begin(), leaves->count, visitLeaf);
    else
        visitWithin(position, reach, visitLeaf);
}

}  // namespace pm
