// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>

#include "integrator/materials/lobes/lobe_point.h"
#include "integrator/sampling/warps.h"

namespace pm {

// A lobe around the mirror direction, rho (n+2)/(2 pi) cos^n(alpha): reciprocal and never above
// rho. Source: Lafortune & Willems 1994.
struct Phong {
    float exponent = 0.0f;  // 0 or more

    Rgb evaluate(const LobePoint& at, const Rgb& reflectance, const Vec3f& in) const {
        if (!at.isReflection(in)) return {};
        const float cosine = dot(in, at.ns);
        const float cosAlpha = dot(in, reflect(at.out, at.ns));
        if (!(cosAlpha > 0.0f)) return {};
        const float value =
            (exponent + 2.0f) * (0.5f * kInvPi) * pinnedPow(std::min(cosAlpha, 1.0f), exponent);
        return reflectance * (value * cosine * at.adjointCorrection(in));
    }

    float pdfSolidAngle(const LobePoint& at, const Vec3f& in, float choice) const {
        const float cosAlpha = dot(in, reflect(at.out, at.ns));
        if (!(cosAlpha > 0.0f)) return 0.0f;
        return choice * (exponent + 1.0f) * (0.5f * kInvPi) *
               pinnedPow(std::min(cosAlpha, 1.0f), exponent);
    }

    bool sample(const LobePoint& at, Vec2f u, BsdfSample& sample) const {
        sample.direction =
            normalize(Frame(reflect(at.out, at.ns)).toWorld(samplePhongLobe(u, exponent)));
        sample.weight *= (exponent + 2.0f) / (exponent + 1.0f) * dot(sample.direction, at.ns) *
                         at.adjointCorrection(sample.direction);
        return at.isReflection(sample.direction);
    }
};

}  // namespace pm
