// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/photon_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

}  // namespace

PhotonMap::PhotonMap(std::span<const Photon> photons, const CancelCheck& cancel)
    : m_tree(buildPhotonTree(photons, cancel)) {
    const float largest = std::max(maxAbsComponent(m_tree.lo), maxAbsComponent(m_tree.hi));
    const float tolerance = PhotonGate::kRounding * largest;
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
    visitLeaves(query.position, last, [&](std::uint32_t leaf) {
        std::array<float, PhotonLeaf::kSize> distances;
        std::uint32_t found = m_tree.leaves[leaf].findWithin(gate, reach, distances.data());
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
    std::uint32_t found = m_tree.leaves[leaf].findWithin(
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

float PhotonMap::typicalRadius(std::uint32_t count) const {
    constexpr std::size_t kProbes = 512;
    const std::size_t step = std::max<std::size_t>(1, size() / kProbes);
    std::vector<float> radii;
    NearestPhotons scratch;
    for (std::size_t i = 0; i < size(); i += step) {
        const auto index = static_cast<std::uint32_t>(i);
        const Photon probe = photon(index);
        // A finite reach whose square is finite too.
        findNearest({probe.position, probe.normal.unpack(), count, 1e18f, index}, scratch);
        if (scratch.found().size() == count)
            radii.push_back(std::sqrt(scratch.found().front().distanceSquared));
    }
    // Photons in one point leave no area to divide by; a bounded answer beats an infinite one.
    const float smallest =
        1e-6f * (length(m_tree.hi - m_tree.lo) + maxAbsComponent(m_tree.hi)) + 1e-18f;
    if (radii.empty()) return std::max(length(m_tree.hi - m_tree.lo), smallest);
    const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
    std::nth_element(radii.begin(), middle, radii.end());
    return std::max(*middle, smallest);
}

std::uint64_t PhotonMap::memoryBytes() const {
    return m_tree.leafCount * sizeof(PhotonLeaf) + m_tree.size * sizeof(Rgb) +
           m_tree.nodeCount() * sizeof(PhotonTree::Node);
}

}  // namespace pm
