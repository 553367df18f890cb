// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/photon_map.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pm {

namespace {

constexpr std::size_t kLeafSize = 16;
// Below this many photons a part of the tree is built by one thread.
constexpr std::size_t kParallelSize = 8192;

}  // namespace

struct PhotonMap::Entry {
    Vec3f position;
    std::uint32_t index;
};

PhotonMap::PhotonMap(std::vector<Photon> photons) {
    const std::size_t count = photons.size();
    while ((count >> m_levels) > kLeafSize) ++m_levels;
    m_nodes.resize((std::size_t{1} << m_levels) - 1);

    std::vector<Entry> entries(count);
    float largest = 0.0f;
    for (std::size_t i = 0; i < count; ++i) {
        entries[i] = {photons[i].position, static_cast<std::uint32_t>(i)};
        largest = std::max(largest, maxAbsComponent(photons[i].position));
    }
    m_planeTolerance = 8.0f * 0x1p-24f * largest;
    buildNode(entries, 0, 0, count, 0);
    m_photons.resize(count);
    for (std::size_t i = 0; i < count; ++i) m_photons[i] = photons[entries[i].index];
}

void PhotonMap::buildNode(std::vector<Entry>& entries, std::size_t node, std::size_t begin,
                          std::size_t end, std::uint32_t level) {
    if (level == m_levels) return;
    Vec3f lo(std::numeric_limits<float>::max()), hi(-std::numeric_limits<float>::max());
    for (std::size_t i = begin; i < end; ++i) {
        const Vec3f& p = entries[i].position;
        lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
        hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
    }
    const Vec3f size = hi - lo;
    const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    const std::size_t middle = begin + (end - begin) / 2;
    // By index where coordinates are equal: a total order, so that the halves are always the same.
    const auto less = [axis](const Entry& a, const Entry& b) {
        const float pa = a.position[axis], pb = b.position[axis];
        return pa < pb || (pa == pb && a.index < b.index);
    };
    const auto at = [&](std::size_t i) { return entries.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), less);
    m_nodes[node] = {entries[middle].position[axis], static_cast<std::uint32_t>(axis)};
    const auto left = [&] { buildNode(entries, 2 * node + 1, begin, middle, level + 1); };
    const auto right = [&] { buildNode(entries, 2 * node + 2, middle, end, level + 1); };
    if (end - begin > kParallelSize) {
        tbb::parallel_invoke(left, right);
    } else {
        left();
        right();
    }
}

void PhotonMap::findNearest(const PhotonQuery& query, NearestPhotons& nearest) const {
    auto& found = nearest.m_found;
    found.clear();
    if (m_photons.empty() || query.count == 0) return;
    float reach = query.maxRadius * query.maxRadius;
    visitLeaves(query.position, reach, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Photon& photon = m_photons[i];
            const Vec3f d = photon.position - query.position;
            const float d2 = lengthSquared(d);
            if (d2 > reach || !matches(photon, d, d2, query.normal) || i == query.leaveOut)
                continue;
            const NearestPhotons::Found candidate{d2, static_cast<std::uint32_t>(i)};
            if (found.size() < query.count) {
                found.push_back(candidate);
                if (found.size() < query.count) continue;
                std::make_heap(found.begin(), found.end());
            } else {
                if (!(candidate < found.front())) continue;
                std::pop_heap(found.begin(), found.end());
                found.back() = candidate;
                std::push_heap(found.begin(), found.end());
            }
            reach = found.front().distanceSquared;
        }
    });
}

float PhotonMap::typicalRadius(std::uint32_t count) const {
    constexpr std::size_t kProbes = 512;
    const std::size_t step = std::max<std::size_t>(1, m_photons.size() / kProbes);
    std::vector<float> radii;
    NearestPhotons scratch;
    for (std::size_t i = 0; i < m_photons.size(); i += step) {
        // A finite reach whose square is finite too.
        findNearest({m_photons[i].position, m_photons[i].normal.unpack(), count, 1e18f,
                     static_cast<std::uint32_t>(i)},
                    scratch);
        if (scratch.found().size() == count)
            radii.push_back(std::sqrt(scratch.found().front().distanceSquared));
    }
    Vec3f lo, hi;
    if (!m_photons.empty()) lo = hi = m_photons[0].position;
    for (const Photon& photon : m_photons)
        for (int axis = 0; axis < 3; ++axis) {
            lo[axis] = std::min(lo[axis], photon.position[axis]);
            hi[axis] = std::max(hi[axis], photon.position[axis]);
        }
    // Photons in one point leave no area to divide by; a bounded answer beats an infinite one.
    const float smallest = 1e-6f * (length(hi - lo) + maxAbsComponent(hi)) + 1e-18f;
    if (radii.empty()) return std::max(length(hi - lo), smallest);
    const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
    std::nth_element(radii.begin(), middle, radii.end());
    return std::max(*middle, smallest);
}

std::uint64_t PhotonMap::memoryBytes() const {
    return m_photons.size() * sizeof(Photon) + m_nodes.size() * sizeof(Node);
}

}  // namespace pm
