// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/emission/aim_cone.h"

#include <algorithm>
#include <cmath>

#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// A cone is wider than its sphere by this share, and by this angle (radians): ten times what
// rounding a direction to float may change. Light that missed its cone by rounding would arrive by
// the unaimed share alone, with a hundredfold flux.
constexpr double kWiderShare = 1e-4, kWiderAngle = 1e-6;
// Beyond this sine a cone is as good as a half space.
constexpr double kWidestSine = 0.9999;
// Mean cosine over what a surface's plane leaves of a cone along it, over the cone's sine: 2/(3 pi)
// of a narrow one, 1/2 of a half space.
constexpr float kGrazingCosine = 0.25f;

// Squared sine of the half angle of the cone around a box's centre, seen along `axis` from
// `distance`; 1 when no cone narrower than a half space holds it.
double boxSineSquared(const Vec3d& axis, double distance, const Vec3d& halfSize) {
    const Vec3d steps = halfSize * axis;
    const double corner2 = lengthSquared(halfSize);
    double largest = 0;
    for (const double sx : {-1.0, 1.0})
        for (const double sy : {-1.0, 1.0})
            for (const double sz : {-1.0, 1.0}) {
                const double off = sx * steps.x + sy * steps.y + sz * steps.z;
                const double along = distance + off;
                if (!(along > 0)) return 1;
                const double across2 = std::max(0.0, corner2 - off * off);
                largest = std::max(largest, across2 / (across2 + along * along));
            }
    return largest;
}

// False when nothing of an uneven light goes into the cone around the unit `axis`.
bool weighByFalloff(const EmissionPoint& from, const Vec3d& axis, double sine, AimCone& cone) {
    const float falloff = from.uneven->largestFalloff(axis, sine);
    if (!(falloff > 0.0f)) return false;
    // What holds most of the light's cone is served by all of that.
    cone.all = cone.oneMinusCos >= from.oneMinusCos;
    cone.solidAngle = falloff * std::min(cone.solidAngle, from.wholeSolidAngle());
    return true;
}

}  // namespace

Vec3f EmissionPoint::sample(Vec2f u, float& pdf) const {
    const Frame frame(axis);
    if (!onSurface) {
        pdf = 1.0f / wholeSolidAngle();
        return normalize(frame.toWorld(sampleUniformCone(u, oneMinusCos)));
    }
    const Vec3f local = sampleCosineHemisphere(u);
    pdf = local.z * kInvPi;
    return normalize(frame.toWorld(local));
}

float EmissionPoint::pdfSolidAngle(const Vec3f& direction) const {
    if (onSurface) return std::max(0.0f, dot(direction, axis)) * kInvPi;
    return lengthSquared(direction - axis) <= 2.0f * oneMinusCos ? 1.0f / wholeSolidAngle() : 0.0f;
}

float EmissionPoint::wholeSolidAngle() const {
    return onSurface ? kPi : 2.0f * kPi * oneMinusCos;
}

bool AimCone::aim(const Caster& caster, const EmissionPoint& from) {
    Vec3d to = caster.centre - from.position;
    double r2 = caster.radius * caster.radius;
    bool clipped = false;
    if (from.onSurface) {
        const double height = dot(to, Vec3d(from.axis));
        if (height <= -caster.radius) return false;
        // Of a sphere with its centre below the plane, what stands above fits into a smaller one
        // with its centre on the plane.
        clipped = height < 0;
        if (clipped) {
            to -= Vec3d(from.axis) * height;
            r2 -= height * height;
        }
    }
    const double d2 = lengthSquared(to);
    double sine2 = d2 > r2 ? r2 / d2 : 1.0;
    if (caster.useBox && !clipped && d2 > 0)
        sine2 = std::min(sine2, boxSineSquared(to / std::sqrt(d2), std::sqrt(d2), caster.halfSize));
    const double sine = std::sqrt(sine2) * (1 + kWiderShare) + kWiderAngle;
    folded = false;
    all = !(sine < kWidestSine);
    if (all) {
        solidAngle = from.wholeSolidAngle();
        return true;
    }
    axis = Vec3f(to / std::sqrt(d2));
    oneMinusCos = static_cast<float>(sine * sine / (1 + std::sqrt(1 - sine * sine)));
    solidAngle = 2.0f * kPi * oneMinusCos;
    if (from.uneven && !weighByFalloff(from, to / std::sqrt(d2), sine, *this)) return false;
    if (from.onSurface) {
        const auto s = static_cast<float>(sine);
        const float cosine = dot(axis, from.axis);
        folded = cosine < s;
        normal = from.axis;
        solidAngle = kPi * s * s * std::max(cosine, kGrazingCosine * s);
    }
    return true;
}

float AimCone::evenDensity() const {
    return 1.0f / (2.0f * kPi * oneMinusCos);
}

Vec3f AimCone::sample(Vec2f u, float& pdf) const {
    const Vec3f direction = normalize(Frame(axis).toWorld(sampleUniformCone(u, oneMinusCos)));
    pdf = evenDensity();
    if (!folded) return direction;
    const bool below = dot(direction, normal) < 0.0f;
    // What was turned up is met in both ways.
    if (below || holds(mirrored(direction))) pdf *= 2.0f;
    return below ? mirrored(direction) : direction;
}

float AimCone::pdfSolidAngle(const Vec3f& direction) const {
    if (!folded) return holds(direction) ? evenDensity() : 0.0f;
    if (dot(direction, normal) < 0.0f || !holds(direction)) return 0.0f;
    return holds(mirrored(direction)) ? 2.0f * evenDensity() : evenDensity();
}

double solidAngleFrom(std::span<const EmissionPoint> points, const Caster& caster) {
    double sum = 0;
    AimCone cone;
    for (const EmissionPoint& point : points)
        if (cone.aim(caster, point)) sum += static_cast<double>(cone.solidAngle);
    return sum;
}

}  // namespace pm
