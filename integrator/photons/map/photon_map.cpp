// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/map/photon_map.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "integrator/photons/map/paged_tree.h"

namespace pm {

namespace {

// As many more as asked for, within these, are kept before the farthest are thrown out together.
constexpr std::size_t kLeastSlack = 8, kMostSlack = 48;
// The first guess of the squared reach: the last query's times this, where that was at most so many
// of its radii away; ...
constexpr float kWarmReach = 1.4f, kWarmWay = 2.0f;
// ... else that of the farthest photon of the leaf around the point, for each photon asked for. Of
// 1, 1.3 and 1.6 the last was the fastest.
constexpr float kColdReach = 1.6f / 50;
// So many of a leaf must count for that.
constexpr int kColdPhotons = 12;
// Where fewer are asked for than a leaf or two hold, the search itself finds out as quickly.
constexpr std::uint32_t kColdCount = 24;
// Leaves are kept for a ball so much wider than a query's.
constexpr float kLeavesReach = 1.2f;
// Room for the rounding of lengths.
constexpr float kLessThanOne = 1.0f - 1e-5f;

// The n-th smallest of the first `count` of some numbers that are at least 0; n: from 1 to count.
// There must be room for 3 more; changes their order.
float nthOf(std::span<float> numbers, std::size_t count, std::uint32_t n) {
#if defined(__SSE2__)
    // Few of them: by how many are smaller than each, without a branch that can't be foreseen.
    constexpr std::size_t kFew = 32;
    if (count <= kFew) {
        std::fill_n(numbers.begin() + static_cast<std::ptrdiff_t>(count), 3,
                    std::numeric_limits<float>::infinity());
        const __m128i most = _mm_set1_epi32(static_cast<std::int32_t>(n));
        __m128 largest = _mm_setzero_ps();
        for (std::size_t j = 0; j < count; j += 4) {
            const __m128 four = _mm_loadu_ps(&numbers[j]);
            __m128i smaller = _mm_setzero_si128();
            for (std::size_t i = 0; i < count; ++i)
                smaller = _mm_sub_epi32(
                    smaller, _mm_castps_si128(_mm_cmplt_ps(_mm_set1_ps(numbers[i]), four)));
            largest = _mm_max_ps(
                largest, _mm_and_ps(_mm_castsi128_ps(_mm_cmpgt_epi32(most, smaller)), four));
        }
        largest = _mm_max_ps(largest, _mm_movehl_ps(largest, largest));
        return _mm_cvtss_f32(_mm_max_ss(largest, _mm_shuffle_ps(largest, largest, 1)));
    }
#endif
    const auto nth = numbers.begin() + (n - 1);
    std::nth_element(numbers.begin(), nth, numbers.begin() + static_cast<std::ptrdiff_t>(count));
    return *nth;
}

}  // namespace

PhotonMap::PhotonMap(std::span<const Photon> photons, const CancelCheck& cancel, float coreRadius)
    : PhotonMap(buildPhotonTree(photons, cancel), coreRadius) {}

PhotonMap::PhotonMap(std::unique_ptr<PhotonSpool> photons, PhotonPaging& paging,
                     const CancelCheck& cancel, float coreRadius)
    : PhotonMap(buildPagedTree(std::move(photons), paging, cancel), coreRadius) {}

PhotonMap::PhotonMap(PhotonTree tree, float coreRadius)
    : m_tree(std::move(tree)),
      m_coreRadius(coreRadius),
      m_largest(std::max(maxAbsComponent(m_tree.lo), maxAbsComponent(m_tree.hi))) {
    const float tolerance = PhotonGate::kRounding * m_largest;
    m_planeToleranceSquared = tolerance * tolerance;
}

// All keys within reach that may be among the nearest, and at most as many more.
void PhotonMap::findWithin(const PhotonQuery& query, float reach, NearestPhotons& nearest) const {
    auto& keys = nearest.m_keys;
    // A whole leaf can be written before the size is looked at.
    const std::size_t wanted = std::min<std::size_t>(query.count, size());
    const std::size_t most = wanted + std::clamp(wanted, kLeastSlack, kMostSlack);
    keys.resize(most + PhotonLeaf::kSize);
    std::uint64_t* const first = keys.data();
    std::size_t count = 0;
    const PhotonGate gate = this->gate(query.position, query.normal);
    std::uint64_t last = keyOf(reach, ~0u);
    LeafReader reader(m_tree);
    visitLeaves(query.position, last, [&](std::uint32_t leaf) {
        std::array<float, PhotonLeaf::kSize> distances;
        std::uint32_t found = reader.places(leaf).findWithin(gate, reach, distances.data());
        for (; found != 0; found &= found - 1) {
            const auto i = static_cast<std::uint32_t>(std::countr_zero(found));
            const std::uint32_t index = leaf * PhotonLeaf::kSize + i;
            first[count] = keyOf(distances[i], index);
            count += index != query.leaveOut;
        }
        if (count < most) return;
        std::nth_element(first, first + query.count - 1, first + count);
        count = query.count;
        last = first[count - 1];
        reach = distanceSquaredOf(last);
    });
    keys.resize(count);
}

// A squared distance within which query.count photons are expected: more of them cost time to throw
// away again, fewer a second search.
float PhotonMap::firstReach(const PhotonQuery& query, const NearestPhotons& nearest) const {
    if (nearest.m_lastMap == this && nearest.m_lastCount == query.count &&
        lengthSquared(query.position - nearest.m_lastPosition) <
            kWarmWay * kWarmWay * nearest.m_lastReach)
        return kWarmReach * nearest.m_lastReach;
    if (query.count < kColdCount) return std::numeric_limits<float>::infinity();
    // A leaf is about a square with the point somewhere inside.
    const std::uint32_t leaf = leafOf(query.position);
    std::array<float, PhotonLeaf::kSize> distances;
    std::uint32_t found = LeafReader(m_tree).places(leaf).findWithin(
        gate(query.position, query.normal), std::numeric_limits<float>::max(), distances.data());
    if (std::popcount(found) < kColdPhotons) return std::numeric_limits<float>::infinity();
    float farthest = 0.0f;
    for (; found != 0; found &= found - 1)
        farthest = std::max(farthest, distances[static_cast<std::size_t>(std::countr_zero(found))]);
    return kColdReach * farthest * static_cast<float>(query.count);
}

std::uint32_t PhotonMap::leafOf(const Vec3f& position) const {
    std::uint32_t node = 0, leaf = 0, count = m_tree.leafCount;
    while (count > 1) {
        const PhotonTree::Node& n = m_tree.nodes[node];
        const std::uint32_t left = PhotonTree::leftLeaves(count);
        const bool isLeft = position[static_cast<int>(n.axis)] < n.split;
        node = 2 * node + (isLeft ? 1 : 2);
        leaf += isLeft ? 0 : left;
        count = isLeft ? left : count - left;
    }
    return leaf;
}

void PhotonMap::findNearest(const PhotonQuery& query, NearestPhotons& nearest) const {
    auto& found = nearest.m_found;
    auto& keys = nearest.m_keys;
    found.clear();
    if (empty() || query.count == 0) return;
    const float widest = query.maxRadius * query.maxRadius;
    float reach = firstReach(query, nearest);
    findWithin(query, std::min(widest, reach), nearest);
    if (keys.size() < query.count && reach < widest) findWithin(query, widest, nearest);
    if (keys.size() >= query.count) {
        std::nth_element(keys.begin(), keys.begin() + (query.count - 1), keys.end());
        keys.resize(query.count);
        std::swap(keys.front(), keys.back());
    }
    found.resize(keys.size());
    for (std::size_t i = 0; i < keys.size(); ++i)
        found[i] = {distanceSquaredOf(keys[i]), static_cast<std::uint32_t>(keys[i])};
    if (found.size() < query.count) return;
    nearest.m_lastMap = this;
    nearest.m_lastPosition = query.position;
    nearest.m_lastCount = query.count;
    nearest.m_lastReach = found.front().distanceSquared;
}

TwoRadii PhotonMap::fluxWithin(const PhotonGate& gate, float radius) const {
    FluxSums sums;
    const float reach = radius * radius;
    LeafReader reader(m_tree);
    visitWithin(gate.position, reach, [&](std::uint32_t leaf) {
        reader.places(leaf).addWithin(gate, reach, reader.fluxes(leaf), sums);
    });
    return radiiOf(sums);
}

TwoRadii PhotonMap::fluxWithin(const Vec3f& position, const Vec3f& normal, float radius) const {
    return fluxWithin(gate(position, normal), radius);
}

TwoRadii PhotonMap::fluxInPlane(const Vec3f& position, const Vec3f& normal, float radius) const {
    PhotonGate plane = gate(position, normal);
    plane.flatnessSquared = 0.0f;
    return fluxWithin(plane, radius);
}

// The leaves within a ball that holds the one of this radius; null where they are too many to keep.
const NearestPhotons::Leaves* PhotonMap::leavesAround(const Vec3f& position, float radius,
                                                      NearestPhotons& nearest) const {
    std::uint32_t mine = nearest.m_newestLeaves;
    if (nearest.m_leaves[mine].map != m_identity) mine = 1 - mine;
    NearestPhotons::Leaves& leaves = nearest.m_leaves[mine];
    nearest.m_newestLeaves = mine;
    if (leaves.map == m_identity) {
        const float left = leaves.radius * kLessThanOne - radius;
        if (left >= 0.0f && lengthSquared(position - leaves.centre) <= left * left) return &leaves;
    } else {
        leaves.map = m_identity;
    }
    leaves.centre = position;
    leaves.radius = kLeavesReach * radius;
    leaves.count = 0;
    bool tooMany = false;
    visitWithin(position, leaves.radius * leaves.radius, [&](std::uint32_t leaf) {
        tooMany = leaves.count == leaves.numbers.size();
        if (!tooMany) leaves.numbers[leaves.count++] = leaf;
    });
    if (!tooMany) return &leaves;
    leaves.radius = 0.0f;
    return nullptr;
}

TwoRadii PhotonMap::fluxWithin(const Vec3f& position, const Vec3f& normal, float radius,
                               NearestPhotons& nearest) const {
    const NearestPhotons::Leaves* const leaves = leavesAround(position, radius, nearest);
    if (!leaves) return fluxWithin(position, normal, radius);
    FluxSums sums;
    const PhotonGate gate = this->gate(position, normal);
    LeafReader reader(m_tree);
    for (std::uint32_t i = 0; i < leaves->count; ++i) {
        const std::uint32_t leaf = leaves->numbers[i];
        reader.places(leaf).addWithin(gate, radius * radius, reader.fluxes(leaf), sums);
    }
    return radiiOf(sums);
}

// A radius within which as many as are asked for are known or likely to be: those of the last query
// are. Infinite where nothing is known.
float PhotonMap::boundOf(const PhotonQuery& query, const NearestPhotons& nearest) const {
    const NearestPhotons::Radius& last = nearest.m_lastRadius;
    if (last.map != m_identity.get() || last.count != query.count ||
        dot(last.normal, query.normal) < PhotonGate::kNormalCosine)
        return std::numeric_limits<float>::infinity();
    return (last.radius + length(query.position - last.position)) / kLessThanOne;
}

// The squared distances of the accepted photons in these leaves, within `reach`; returns how
// many.
std::size_t PhotonMap::findDistances(const PhotonQuery& query, float reach,
                                     const NearestPhotons::Leaves& leaves,
                                     std::vector<float>& distances) const {
    const PhotonGate gate = this->gate(query.position, query.normal);
    distances.resize((leaves.numbers.size() + 1) * PhotonLeaf::kSize);
    std::size_t count = 0;
    LeafReader reader(m_tree);
    for (std::uint32_t i = 0; i < leaves.count; ++i) {
        const std::uint32_t leaf = leaves.numbers[i];
        std::array<float, PhotonLeaf::kSize> all;
        std::uint32_t found = reader.places(leaf).findWithin(gate, reach, all.data());
        for (; found != 0; found &= found - 1) {
            const auto k = static_cast<std::uint32_t>(std::countr_zero(found));
            distances[count] = all[k];
            count += leaf * PhotonLeaf::kSize + k != query.leaveOut;
        }
    }
    return count;
}

float PhotonMap::radiusOf(const PhotonQuery& query, NearestPhotons& nearest) const {
    constexpr float kNone = std::numeric_limits<float>::infinity();
    if (query.count == 0) return kNone;
    const float known = boundOf(query, nearest);
    const float bound = std::min(known, query.maxRadius);
    const auto remember = [&](float squared) {
        const float radius = std::sqrt(squared);
        nearest.m_lastRadius = {query.position, query.normal, query.count, radius,
                                m_identity.get()};
        return radius;
    };
    const NearestPhotons::Leaves* const leaves =
        known < kNone ? leavesAround(query.position, bound, nearest) : nullptr;
    if (leaves) {
        auto& distances = nearest.m_distances;
        const std::size_t count = findDistances(query, bound * bound, *leaves, distances);
        if (count >= query.count) return remember(nthOf(distances, count, query.count));
        if (bound == query.maxRadius) return kNone;
    }
    findNearest(query, nearest);
    const auto& found = nearest.found();
    return found.size() == query.count ? remember(found.front().distanceSquared) : kNone;
}

float PhotonMap::typicalRadius(std::uint32_t count) const {
    constexpr std::size_t kProbes = 512;
    const std::size_t step = std::max<std::size_t>(1, size() / kProbes);
    std::vector<float> radii((size() + step - 1) / step);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, radii.size(), 8), [&](const auto& range) {
        NearestPhotons scratch;
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const auto index = static_cast<std::uint32_t>(i * step);
            const Photon probe = photon(index);
            // A finite reach whose square is finite too.
            radii[i] =
                radiusOf({probe.position, probe.normal.unpack(), count, 1e18f, index}, scratch);
        }
    });
    std::erase(radii, std::numeric_limits<float>::infinity());
    // Photons in one point leave no area to divide by; a bounded answer beats an infinite one.
    const float smallest =
        1e-6f * (length(m_tree.hi - m_tree.lo) + maxAbsComponent(m_tree.hi)) + 1e-18f;
    if (radii.empty()) return std::max(length(m_tree.hi - m_tree.lo), smallest);
    const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
    std::nth_element(radii.begin(), middle, radii.end());
    return std::max(*middle, smallest);
}

std::uint64_t PhotonMap::memoryBytes() const {
    const std::uint64_t nodes = m_tree.nodeCount() * sizeof(PhotonTree::Node);
    if (m_tree.pages) return nodes + m_tree.pages->memoryBytes();
    return m_tree.leafCount * sizeof(PhotonLeaf) + m_tree.leafCount * sizeof(LeafFluxes) + nodes;
}

}  // namespace pm
