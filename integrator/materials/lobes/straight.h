// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/materials/lobes/lobe_point.h"

namespace pm {

// What goes straight on: where the surface is not there, or bends nothing.
struct Straight {
    static Rgb reflectance(const LobePoint& at) {
        if (at.straightEtaSquared == 1.0f) return at.straight;
        const float squared = at.straightEtaSquared * at.straightEtaSquared;
        return at.transport == Transport::kRadiance ? at.straight : at.straight * squared;
    }

    static bool sample(const LobePoint& at, BsdfSample& sample) {
        sample.direction = -at.out;
        sample.etaSquared = at.straightEtaSquared;
        return true;
    }
};

}  // namespace pm
