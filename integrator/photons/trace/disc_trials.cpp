// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/trace/disc_trials.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "integrator/photons/map/photon_leaf.h"
#include "integrator/photons/map/photon_tree.h"

namespace pm {

namespace {

// Leaves that are tried at a time, and those of the smallest region with a disc of its own.
constexpr std::uint32_t kGrain = 32, kLeavesOfRegion = 32;
// What is known of the region around counts for as many photons of a region's own.
constexpr double kPhotonsOfExpected = 3072;
// Of a pilot itself it is expected that light is even, for as many photons: of a few hundred alone,
// pairs on small discs are mere chance.
constexpr double kPhotonsOfEven = 1000;
// A disc of half the area has to be better by this, relative: pilots of even light are as unsure.
constexpr double kDoubt = 0.015;
// The widest disc holds about as many of the pilot's photons as are looked for; within this many of
// its radii nearly always twice as many of one half.
constexpr float kReach = 2.0f;

double fluxOf(const Photon& photon) {
    return channelSum(photon.flux);
}

}  // namespace

// Working memory.
struct DiscTrials::Trial {
    struct Found {
        float distanceSquared, flux;
        friend bool operator<(const Found& a, const Found& b) {
            return a.distanceSquared < b.distanceSquared;
        }
    };
    NearestPhotons scratch;
    std::vector<Found> own, other;  // of the half of the photon that is tried

    void find(const PhotonMap& pilot, std::uint32_t index, float reach) {
        const Photon photon = pilot.photon(index);
        own.clear();
        other.clear();
        pilot.visitAccepted(
            photon.position, photon.normal.unpack(), reach, scratch,
            [&](std::uint32_t i, float distanceSquared) {
                if (i == index) return;
                const Photon found = pilot.photon(i);
                const bool isOwn = found.normal.isMarked() == photon.normal.isMarked();
                (isOwn ? own : other)
                    .push_back({distanceSquared, static_cast<float>(fluxOf(found))});
            });
    }
};

DiscTrials::Sums& DiscTrials::Sums::operator+=(const Sums& other) {
    for (std::size_t i = 0; i < density.size(); ++i) density[i] += other.density[i];
    noise += other.noise;
    weight += other.weight;
    return *this;
}

DiscTrials::Sums& DiscTrials::Sums::operator-=(const Sums& other) {
    for (std::size_t i = 0; i < density.size(); ++i) density[i] -= other.density[i];
    noise -= other.noise;
    weight -= other.weight;
    return *this;
}

DiscTrials::Sums& DiscTrials::Sums::operator*=(double factor) {
    for (double& value : density) value *= factor;
    noise *= factor;
    weight *= factor;
    return *this;
}

DiscTrials::DiscTrials(const PhotonMap& pilot, const Request& request, const CancelCheck& cancel)
    : m_pilot(pilot), m_request(request), m_shares(pilot.size(), 1.0f) {
    const auto size = static_cast<std::uint32_t>(pilot.size());
    const std::uint32_t leaves = (size + PhotonLeaf::kSize - 1) / PhotonLeaf::kSize;
    for (std::uint32_t i = 0; i < size; ++i) m_meanFlux += fluxOf(pilot.photon(i));
    if (!(m_meanFlux > 0)) return;
    m_meanFlux /= size;
    m_before.resize(leaves + 1);
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, leaves, kGrain), [&](const auto& range) {
        cancel.throwIfSet("finding the radii of caustics");
        Trial trial;
        for (std::uint32_t leaf = range.begin(); leaf < range.end(); ++leaf)
            m_before[leaf + 1] = tryOn(leaf, trial);
    });
    for (std::uint32_t leaf = 0; leaf < leaves; ++leaf) m_before[leaf + 1] += m_before[leaf];
    if (!(m_before[leaves].weight > 0)) return;
    Sums even;
    even.density.fill(1);
    even.noise = m_before[leaves].noise / m_before[leaves].weight;
    even.weight = 1;
    even *= kPhotonsOfEven * m_meanFlux;
    even += m_before[leaves];
    choose(0, leaves, even);
}

DiscTrials::Sums DiscTrials::tryOn(std::uint32_t leaf, Trial& trial) const {
    Sums sums;
    const std::uint32_t first = leaf * PhotonLeaf::kSize;
    const auto end =
        std::min(first + PhotonLeaf::kSize, static_cast<std::uint32_t>(m_pilot.size()));
    for (std::uint32_t i = first; i < end; ++i) addPhoton(i, trial, sums);
    return sums;
}

// The widest disc is one that holds so many of the photon's own half: were it chosen by the other
// half, too, what is counted of that would be biased.
void DiscTrials::addPhoton(std::uint32_t index, Trial& trial, Sums& sums) const {
    const Photon photon = m_pilot.photon(index);
    const bool isThin = !(m_request.radii[index] <= m_request.largest);
    const float reach = kReach * (isThin ? m_request.largest : m_request.radii[index]);
    trial.find(m_pilot, index, reach);
    const std::size_t half = std::max(1u, m_request.count / 2);
    float widest = m_request.largest * m_request.largest;
    if (trial.own.size() >= half) {
        const auto last = trial.own.begin() + static_cast<std::ptrdiff_t>(half - 1);
        std::nth_element(trial.own.begin(), last, trial.own.end());
        widest = std::min(widest, last->distanceSquared);
    } else if (!isThin) {
        return;
    }
    // Photons in one point tell of no area; and what lies beyond has not been looked at.
    if (!(widest > 0.0f) || 2.0f * widest > reach * reach) return;
    double own = 0;
    for (const Trial::Found& found : trial.own)
        if (found.distanceSquared <= widest) own += static_cast<double>(found.flux);
    if (!(own > 0)) return;
    const double flux = fluxOf(photon), weight = flux / own;
    float area = 2.0f * widest;
    double scale = 0.5;
    for (double& density : sums.density) {
        for (const Trial::Found& found : trial.other)
            if (found.distanceSquared <= area)
                density += weight * scale * static_cast<double>(found.flux);
        area *= 0.5f;
        scale *= 2;
    }
    sums.noise += 0.5 * flux * weight;
    sums.weight += flux;
}

// From the whole pilot down to regions, each half of the one before: what a region shows itself,
// and what is expected of it by the one that it is a part of.
void DiscTrials::choose(std::uint32_t first, std::uint32_t count, const Sums& expected) {
    Sums sums = m_before[first + count];
    sums -= m_before[first];
    Sums prior = expected;
    prior *= kPhotonsOfExpected * m_meanFlux / expected.weight;
    sums += prior;
    if (count > kLeavesOfRegion) {
        const std::uint32_t left = PhotonTree::leftLeaves(count);
        choose(first, left, sums);
        choose(first + left, count - left, sums);
        return;
    }
    const std::size_t begin = std::size_t{first} * PhotonLeaf::kSize;
    const std::size_t end =
        std::min(begin + std::size_t{count} * PhotonLeaf::kSize, m_shares.size());
    std::fill(m_shares.begin() + static_cast<std::ptrdiff_t>(begin),
              m_shares.begin() + static_cast<std::ptrdiff_t>(end), bestOf(sums));
}

// With P(a) the density that photons find around them on a disc of area a, the squared bias of an
// estimate there is P(0) - 2 P(a) + P(2a): P(a) is the mean over the light's spectrum of the disc's
// transform; of that less 1, squared, the square is the transform of two such discs in turn, which
// is near enough that of one disc with twice the area. P(0) is the same for all.
float DiscTrials::bestOf(const Sums& sums) const {
    std::size_t best = 0;
    double least = 0, noise = m_request.noiseShare * sums.noise;
    for (std::size_t i = 0; i < kDiscs; ++i, noise *= 2) {
        const double error = sums.density[i] - 2 * sums.density[i + 1] + noise +
                             kDoubt * static_cast<double>(i) * sums.weight;
        if (i > 0 && !(error < least)) continue;
        best = i;
        least = error;
    }
    return std::pow(0.5f, 0.5f * static_cast<float>(best));
}

}  // namespace pm
