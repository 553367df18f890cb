// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/path_walk.h"

#include <algorithm>

namespace pm {

namespace {

constexpr int kEventsBeforeRoulette = 5;

}  // namespace

bool PathWalk::scatter(const Surface& surface, const Bsdf& bsdf, const BsdfSample& sample,
                       Sampler& sampler, bool isPart) {
    followLobe(bsdf, sample);
    if (isPart) m_whole = std::min(m_whole, amount());
    if (++m_events == kMostPathEvents || amount() == 0.0f) return false;
    if (m_events >= kEventsBeforeRoulette) {
        const float survival = std::min(1.0f, amount() / m_whole);
        if (survival < 1.0f) {
            if (sampler.next1D() >= survival) return false;
            throughput *= 1.0f / survival;
        }
    }
    ray = rayFrom(surface, sample.direction);
    return true;
}

}  // namespace pm
