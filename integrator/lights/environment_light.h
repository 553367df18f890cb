// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/lights/box_shadow.h"
#include "integrator/lights/environment.h"
#include "integrator/lights/light_place.h"
#include "integrator/lights/light_sample.h"
#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

// The light of an environment, which must outlive it.
struct EnvironmentLight {
    static constexpr LightPlace kPlace = LightPlace::kFar;

    const Environment* environment;

    // A convex body's shadow is a quarter of its surface on the average (Cauchy).
    double powerMean(const SceneBox& box) const {
        double area = 0;
        for (const Vec3d& axis : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}})
            area += 0.5 * crossSection(box.halfSize, axis);
        return environment->integral() * area;
    }
    static bool isMet() { return true; }
    Rgb radianceAlong(const Vec3f& direction) const { return environment->radiance(direction); }
    FarLook look(Vec2f u) const {
        FarLook look;
        look.direction = environment->sample(u, look.pdfSolidAngle);
        look.radiance = environment->radiance(look.direction);
        return look;
    }
    float pdfSolidAngle(const Vec3f& direction, float probability) const {
        return probability * environment->pdfSolidAngle(direction);
    }
    bool emit(Vec2f u, ParallelLight& parallel) const {
        const FarLook seen = look(u);
        parallel = {-seen.direction, seen.radiance * (1.0f / seen.pdfSolidAngle)};
        return !isBlack(parallel.irradiance);
    }
};

}  // namespace pm
