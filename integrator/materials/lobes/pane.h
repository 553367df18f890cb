// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/materials/lobes/dielectric.h"

namespace pm {

// Both boundaries of a body of glass so thin that no ray starts inside it.
struct Pane {
    Rgb tint;          // at each boundary
    float eta = 1.0f;  // index of the glass over that around it

    // With R of one boundary, and the tint at each passage: (1 - R)^2 goes through both, and of the
    // (1 - R) inside R^2, R^4 ... are sent to and fro before they leave.
    SmoothShares shares(const LobePoint& at) const {
        const float reflected = fresnelDielectric(clamp01(dot(at.out, at.ns)), eta);
        const float through = (1.0f - reflected) / (1.0f + reflected);
        return {Rgb(reflected) + tint * tint * (reflected * through), tint * tint * through};
    }
    static bool sendsByWays(const LobePoint&) { return false; }

    static bool sample(const LobePoint& at, float, BsdfSample& sample) {
        return sample.lobe == Lobe::kReflection ? reflectOn(at, sample)
                                                : refractOn(at, 1.0f, sample);
    }
};

}  // namespace pm
