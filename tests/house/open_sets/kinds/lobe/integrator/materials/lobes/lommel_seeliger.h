// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>

#include "integrator/materials/lobes/lobe_point.h"
#include "integrator/sampling/warps.h"

namespace pm {

// Dark dust, that scatters once: f = reflectance / (4 pi (cos in + cos out)), so half of what comes
// in along the normal leaves at grazing angles. Source: Seeliger 1887.
struct LommelSeeliger {
    static Rgb albedo(const LobePoint& at, const Rgb& reflectance) {
        const float c = std::max(1e-4f, dot(at.out, at.ng));
        return reflectance * (0.5f * (1.0f - c * std::log((1.0f + c) / c)));
    }
    static float arrival(const LobePoint&) { return 1.0f; }
    static Rgb evaluate(const LobePoint& at, const Rgb& reflectance, const Vec3f& in) {
        const float i = dot(in, at.ng), o = dot(at.out, at.ng);
        return i > 0.0f ? reflectance * (0.25f * kInvPi * i / (i + std::max(o, 1e-4f))) : Rgb();
    }
    static float pdfSolidAngle(const LobePoint& at, const Vec3f& in, float choice) {
        return choice * std::max(0.0f, dot(in, at.ng)) * kInvPi;
    }
    static bool sample(const LobePoint& at, Vec2f u, BsdfSample& sample) {
        sample.direction = normalize(Frame(at.ng).toWorld(sampleCosineHemisphere(u)));
        const float i = dot(sample.direction, at.ng), o = dot(at.out, at.ng);
        sample.weight *= 0.25f / (i + std::max(o, 1e-4f));
        return i > 0.0f;
    }
};

}  // namespace pm
