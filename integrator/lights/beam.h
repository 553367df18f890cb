// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/values/vec.h"

namespace pm {

// The directions in which a spot or a directional light shines.
struct Beam {
    Vec3f axis;                // unit, the way that light travels along the middle
    float oneMinusCos = 0.0f;  // of the whole cone's half angle; 0: along the axis alone
    // Of the inner cone in which a spot has its whole intensity; between the two it fades as
    // 3 t^2 - 2 t^3, t the share of the way in the cosine.
    float innerOneMinusCos = 0.0f;

    // angle: half of the whole cone's, radians, in [0, pi]; falloff: of it, where light fades.
    static Beam make(const Vec3d& axis, double angle, double falloff);

    bool isDelta() const { return oneMinusCos == 0.0f; }
    // Whether light travels along a unit direction; with sides of the cone as narrow as float has
    // them: |d - axis|^2 = 2 (1 - cos).
    bool holds(const Vec3f& direction) const {
        return lengthSquared(direction - axis) <= 2.0f * oneMinusCos;
    }
    // Of a spot's whole intensity, what it sends along a unit direction; in [0, 1].
    float intensity(const Vec3f& direction) const {
        return intensityAt(0.5f * lengthSquared(direction - axis));
    }
    // The same at an angle to the axis.
    float intensityAt(float oneMinusCosOfAngle) const;
    // At most, in a cone around a unit axis with this sine of its half angle.
    float largestIntensity(const Vec3d& coneAxis, double sine) const;
    // The intensity's integral over all directions, sr.
    float fluxOverIntensity() const;
    // A unit direction with a density in proportion to the intensity; pdf: that density, sr^-1.
    Vec3f sampleIntensity(Vec2f u, float& pdf) const;
};

}  // namespace pm
