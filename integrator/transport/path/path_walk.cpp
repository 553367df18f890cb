// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/path/path_walk.h"

#include <algorithm>

#include "integrator/materials/follow_footprint.h"

namespace pm {

namespace {

constexpr int kEventsBeforeRoulette = 5;

}  // namespace

bool PathWalk::scatter(const Surface& surface, const Bsdf& bsdf, const BsdfSample& sample,
                       Sampler& sampler, bool isPart) {
    followLobe(bsdf, sample);
    if (isPart) m_whole = std::min(m_whole, amount());
    if (amount() == 0.0f) return false;
    const float survival = m_events.add(std::min(1.0f, amount() / m_whole));
    m_isCut = m_events.isOver();
    if (m_isCut) return false;
    if (m_events.count() >= kEventsBeforeRoulette && survival < 1.0f) {
        if (sampler.next1D() >= survival) return false;
        throughput *= 1.0f / survival;
    }
    followFootprint(ray.direction, surface, bsdf, sample, footprint);
    const Viewers viewer = ray.viewer;
    ray = rayFrom(surface, sample.direction);
    if (sample.lobe == Lobe::kStraight) ray.viewer = viewer;
    return true;
}

}  // namespace pm
