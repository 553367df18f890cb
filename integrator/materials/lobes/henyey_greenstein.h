// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>

#include "integrator/materials/lobes/lobe_point.h"
#include "integrator/sampling/pinned_math.h"
#include "integrator/sampling/warps.h"

namespace pm {

// How a medium scatters at a place: by the angle from the way that light has come, with mean cosine
// g. There is no surface, so no cosine, and light leaves to all sides. Source: Henyey & Greenstein
// 1941, eq. 2; sampled by the inverse of its integral over the cosine.
struct HenyeyGreenstein {
    float g = 0.0f;  // in (-1, 1); 0: evenly

    Rgb evaluate(const LobePoint& at, const Rgb& reflectance, const Vec3f& in) const {
        return reflectance * density(at, in);
    }

    float pdfSolidAngle(const LobePoint& at, const Vec3f& in, float choice) const {
        return choice * density(at, in);
    }

    bool sample(const LobePoint& at, Vec2f u, BsdfSample& sample) const {
        float cosine = 1.0f - 2.0f * u.x;
        if (std::abs(g) > kEven) {
            const float root = (1.0f - g * g) / (1.0f - g + 2.0f * g * u.x);
            cosine = (1.0f + g * g - root * root) / (2.0f * g);
        }
        cosine = std::clamp(cosine, -1.0f, 1.0f);
        const float sine = std::sqrt(1.0f - cosine * cosine);
        const SinCos turn = sinCosTurns(u.y);
        sample.direction =
            normalize(Frame(-at.out).toWorld({sine * turn.cos, sine * turn.sin, cosine}));
        return true;
    }

  private:
    // Where g is so small the inverse of the integral has no digits left.
    static constexpr float kEven = 1e-3f;

    float density(const LobePoint& at, const Vec3f& in) const {
        const float base = 1.0f + g * g + 2.0f * g * dot(at.out, in);
        return 0.25f * kInvPi * (1.0f - g * g) / (base * std::sqrt(base));
    }
};

}  // namespace pm
