// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "integrator/sampling/pinned_math.h"
#include "integrator/values/vec.h"

// Maps from the unit square to directions and surfaces, each with its density.
namespace pm {

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr float kInvPi = std::numbers::inv_pi_v<float>;

// An orthonormal frame around a unit vector. Source: Duff et al., "Building an Orthonormal Basis,
// Revisited", JCGT 6(1), 2017. It jumps where their sign does: there, by z, it would turn at every
// wall along z by what rounding makes of 0, and with it all directions that are sampled. So the
// sign is of a plane that no axis nor diagonal lies in.
struct Frame {
    // Small enough that sign + n.z is no less than 2/3.
    static constexpr float kTiltX = 0.31f, kTiltY = 0.17f;

    Vec3f tangent, bitangent, normal;

    explicit Frame(const Vec3f& n) : normal(n) {
        const float sign = std::copysign(1.0f, kTiltX * n.x + kTiltY * n.y + n.z);
        const float a = -1.0f / (sign + n.z);
        const float b = n.x * n.y * a;
        tangent = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
        bitangent = {b, sign + n.y * n.y * a, -n.y};
    }
    // The tangent as near as can be to a direction; any, where that is along the normal or none.
    Frame(const Vec3f& n, const Vec3f& along) : Frame(n) {
        const Vec3f flat = along - n * dot(along, n);
        const float l2 = lengthSquared(flat);
        if (!(l2 > 1e-12f)) return;
        tangent = flat / std::sqrt(l2);
        bitangent = cross(n, tangent);
    }
    Vec3f toWorld(const Vec3f& v) const { return tangent * v.x + bitangent * v.y + normal * v.z; }
    Vec3f toLocal(const Vec3f& v) const {
        return {dot(v, tangent), dot(v, bitangent), dot(v, normal)};
    }
};

// Directions around +z with density cos(theta)/pi.
inline Vec3f sampleCosineHemisphere(Vec2f u) {
    const float radius = std::sqrt(u.x);
    const SinCos phi = sinCosTurns(u.y);
    return {radius * phi.cos, radius * phi.sin, std::sqrt(std::max(0.0f, 1.0f - u.x))};
}

// Directions over the whole sphere with density 1/(4 pi).
inline Vec3f sampleUniformSphere(Vec2f u) {
    const float z = 1.0f - 2.0f * u.x;
    const float radius = std::sqrt(std::max(0.0f, 1.0f - z * z));
    const SinCos phi = sinCosTurns(u.y);
    return {radius * phi.cos, radius * phi.sin, z};
}

// Directions within an angle of +z whose cosine is 1 - oneMinusCos, density
// 1/(2 pi oneMinusCos). Taking 1 - cos keeps narrow cones accurate.
inline Vec3f sampleUniformCone(Vec2f u, float oneMinusCos) {
    const float d = u.x * oneMinusCos;
    const float radius = std::sqrt(std::max(0.0f, d * (2.0f - d)));
    const SinCos phi = sinCosTurns(u.y);
    return {radius * phi.cos, radius * phi.sin, 1.0f - d};
}

// Directions around +z with density (n+1)/(2 pi) cos^n(theta).
inline Vec3f samplePhongLobe(Vec2f u, float exponent) {
    const float z = pinnedPow(1.0f - u.x, 1.0f / (exponent + 1.0f));
    const float radius = std::sqrt(std::max(0.0f, 1.0f - z * z));
    const SinCos phi = sinCosTurns(u.y);
    return {radius * phi.cos, radius * phi.sin, z};
}

// Barycentric coordinates (b1, b2) uniform over a triangle.
inline Vec2f sampleTriangle(Vec2f u) {
    const float root = std::sqrt(u.x);
    return {1.0f - root, u.y * root};
}

// 1 - cos of the half angle under which a sphere of squared radius r2 is seen from the squared
// distance d2 > r2.
inline float oneMinusCosOfSphere(double r2, double d2) {
    const double sin2 = r2 / d2;
    return static_cast<float>(sin2 / (1.0 + std::sqrt(1.0 - sin2)));
}

// Points of the unit square, [0,1), evenly spread: `start` moved by i steps of the generalised
// golden ratio (Roberts 2018), round the square.
inline Vec2f spreadPoint(std::uint32_t i, Vec2f start = {0.5f, 0.5f}) {
    const auto around = [](double v) {
        return std::min(static_cast<float>(v - std::floor(v)), 1.0f - 0x1p-24f);
    };
    return {around(static_cast<double>(start.x) + 0.7548776662466927 * i),
            around(static_cast<double>(start.y) + 0.5698402909980532 * i)};
}

// Weight of the strategy with density a against the one with density b: the power heuristic.
// Source: Veach 1997, section 9.2.4, exponent 2. Written in ratios so that huge densities don't
// overflow.
inline float powerHeuristic(float a, float b) {
    if (!(a > 0.0f)) return 0.0f;
    const float ratio = b / a;
    return 1.0f / (1.0f + ratio * ratio);
}

}  // namespace pm
