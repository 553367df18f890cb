// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/materials/lobes/lobe_point.h"

namespace pm {

// The share of the surface that is not there.
struct Straight {
    static Rgb reflectance(const LobePoint& at) { return Rgb(1.0f - at.opacity); }

    static bool sample(const LobePoint& at, BsdfSample& sample) {
        sample.direction = -at.out;
        return true;
    }
};

}  // namespace pm
