// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>

#include "integrator/lights/light.h"
#include "integrator/values/vec.h"

namespace pm {

// Bounds of something to aim at: a sphere, and a box around the same centre that is used as well
// where it is narrower from some side.
struct Caster {
    Vec3d centre;         // scene's own coordinates
    double radius = 0.0;  // scene units
    Vec3d halfSize{};     // of the box, along the axes; scene units
    bool useBox = false;
};

// A point that light leaves, and the directions in which it does.
struct EmissionPoint {
    Vec3d position;  // scene's own coordinates
    // Of a point on a surface: its normal; light leaves by the cosine, to that side only. Of a
    // light without area: the axis of the cone that it fills, evenly or as its falloff says.
    Vec3f axis;
    bool onSurface = false;
    float oneMinusCos = 2.0f;       // of that cone
    const Light* uneven = nullptr;  // the light, where its falloff isn't 1 everywhere

    // Direction of unaimed emission, unit, and its density; of such a light even over its cone.
    Vec3f sample(Vec2f u, float& pdfSolidAngle) const;
    float pdfSolidAngle(const Vec3f& direction) const;
    // Solid angle of all directions, on a surface weighted by the cosine; sr.
    float wholeSolidAngle() const;
};

// The directions from a point of emission to a caster, taken evenly from the cone that holds it.
// Where the point lies on a surface whose plane cuts the cone, what lies below the plane is turned
// up, so that no direction is wasted: a cone whose axis is not below the plane holds the mirror
// image of all that is.
struct AimCone {
    Vec3f axis;                // unit
    Vec3f normal;              // where folded: of the plane
    float oneMinusCos = 0.0f;  // of its half angle
    bool folded = false;
    bool all = false;  // the point lies inside or next to the caster: unaimed emission serves it
    // Solid angle, on a surface about that weighted by the cosine, of an uneven light by the
    // largest intensity in the cone; > 0, sr.
    float solidAngle = 0.0f;

    // False when the whole caster lies behind the point's surface or beside its cone. The cone is a
    // little wider than the caster, beyond what rounding may do to a direction.
    bool aim(const Caster& caster, const EmissionPoint& from);

    // Not for `all`. Unit direction; density sr^-1, as the one that made the direction knows it.
    Vec3f sample(Vec2f u, float& pdfSolidAngle) const;
    float pdfSolidAngle(const Vec3f& direction) const;

  private:
    float evenDensity() const;
    bool holds(const Vec3f& direction) const {
        // |d - axis|^2 = 2 (1 - cos): exact where the cosine of a narrow cone would not be.
        return lengthSquared(direction - axis) <= 2.0f * oneMinusCos;
    }
    Vec3f mirrored(const Vec3f& direction) const {
        return direction - normal * (2.0f * dot(direction, normal));
    }
};

// AimCone::solidAngle of a caster, summed over points of emission; sr.
double solidAngleFrom(std::span<const EmissionPoint> points, const Caster& caster);

}  // namespace pm
