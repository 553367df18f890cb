// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/lights/beam.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "integrator/sampling/warps.h"

namespace pm {

namespace {

float oneMinusCosOf(double angle) {
    if (angle >= std::numbers::pi) return 2.0f;
    const double sine =
        static_cast<double>(sinCosTurns(static_cast<float>(0.25 * angle / std::numbers::pi)).sin);
    return static_cast<float>(2.0 * sine * sine);
}

// Where the integral of 3 t^2 - 2 t^3 from 0 is the share u of that to 1: t^3 (2 - t) = u.
float invertFalloff(float u) {
    float lo = 0.0f, hi = 1.0f;
    for (int i = 0; i < 24; ++i) {
        const float t = 0.5f * (lo + hi);
        (t * t * t * (2.0f - t) < u ? lo : hi) = t;
    }
    return 0.5f * (lo + hi);
}

}  // namespace

Beam Beam::make(const Vec3d& axis, double angle, double falloff) {
    return {Vec3f(normalize(axis)), oneMinusCosOf(angle),
            oneMinusCosOf(std::max(0.0, angle - falloff))};
}

float Beam::intensityAt(float oneMinusCosOfAngle) const {
    const float d = std::min(oneMinusCosOfAngle, 2.0f);
    if (d <= innerOneMinusCos) return 1.0f;
    if (d >= oneMinusCos) return 0.0f;
    const float t = (oneMinusCos - d) / (oneMinusCos - innerOneMinusCos);
    return t * t * (3.0f - 2.0f * t);
}

float Beam::largestIntensity(const Vec3d& coneAxis, double sine) const {
    const double cosine = std::sqrt(1 - sine * sine);
    const double between = dot(coneAxis, Vec3d(axis));
    if (between >= cosine) return 1.0f;
    const double sineBetween = std::sqrt(std::max(0.0, 1 - between * between));
    // Of the difference of the two angles.
    return intensityAt(
        static_cast<float>(std::max(0.0, 1 - between * cosine - sineBetween * sine)));
}

float Beam::fluxOverIntensity() const {
    return kPi * (innerOneMinusCos + oneMinusCos);
}

Vec3f Beam::sampleIntensity(Vec2f u, float& pdf) const {
    const float whole = 0.5f * (innerOneMinusCos + oneMinusCos);
    float d = u.x * whole;
    float value = 1.0f;
    if (d > innerOneMinusCos) {
        // Counted from the edge of the cone, where t is 0.
        const float fading = oneMinusCos - innerOneMinusCos;
        const float t = invertFalloff(std::max(0.0f, (whole - d) / (0.5f * fading)));
        d = oneMinusCos - t * fading;
        value = t * t * (3.0f - 2.0f * t);
    }
    pdf = value / fluxOverIntensity();
    const float radius = std::sqrt(std::max(0.0f, d * (2.0f - d)));
    const SinCos phi = sinCosTurns(u.y);
    return normalize(Frame(axis).toWorld({radius * phi.cos, radius * phi.sin, 1.0f - d}));
}

}  // namespace pm
