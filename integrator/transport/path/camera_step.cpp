// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/path/camera_step.h"

#include <algorithm>

#include "integrator/materials/follow_footprint.h"

namespace pm {

namespace {

constexpr int kEventsBeforeRoulette = 5;

}  // namespace

void CameraStep::leave(const Surface& surface, const Bsdf& bsdf, const BsdfSample& sample) {
    followFootprint(ray.direction, surface, bsdf, sample, footprint);
    goOn(rayFrom(surface, sample.direction), sample.lobe);
}

bool CameraStep::scatter(const Surface& surface, const Bsdf& bsdf, const BsdfSample& sample,
                         bool isPart) {
    takeLobe(sample);
    if (isPart) m_whole = std::min(m_whole, amount());
    if (amount() == 0.0f) return false;
    const float survival = events.add(std::min(1.0f, amount() / m_whole));
    m_isCut = events.isOver();
    if (m_isCut) return false;
    if (events.count() >= kEventsBeforeRoulette && survival < 1.0f) {
        if (random.get1D(Purpose::kRoulette) >= survival) return false;
        carried *= 1.0f / survival;
    }
    leave(surface, bsdf, sample);
    return true;
}

}  // namespace pm
