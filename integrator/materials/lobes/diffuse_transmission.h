// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>

#include "integrator/materials/lobes/lobe_point.h"
#include "integrator/sampling/warps.h"

namespace pm {

// Lets light through alike to all sides, as leaves and lampshades do.
struct DiffuseTransmission {
    static Rgb evaluate(const LobePoint& at, const Rgb& reflectance, const Vec3f& in) {
        const float geometric = -dot(in, at.ng), shading = -dot(in, at.nd);
        if (!(geometric > 0.0f)) return {};
        if (at.transport == Transport::kPhotons)
            return reflectance * (kInvPi * geometric * at.normalRatio());
        return shading > 0.0f ? reflectance * (kInvPi * shading) : Rgb();
    }
    static float pdfSolidAngle(const LobePoint& at, const Vec3f& in, float choice) {
        return choice * std::max(0.0f, -dot(in, at.diffuseAxis())) * kInvPi;
    }
    static bool sample(const LobePoint& at, Vec2f u, BsdfSample& sample) {
        sample.direction = -normalize(Frame(at.diffuseAxis()).toWorld(sampleCosineHemisphere(u)));
        if (at.transport == Transport::kPhotons) sample.weight *= at.normalRatio();
        return dot(sample.direction, at.ng) < 0.0f;
    }
};

}  // namespace pm
