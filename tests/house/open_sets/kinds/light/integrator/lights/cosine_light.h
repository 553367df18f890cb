// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <numbers>
#include <string>

#include "integrator/lights/light_place.h"
#include "integrator/sampling/warps.h"
#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

struct CosineLight;

// A light without area whose intensity falls by the cosine, as a small flat lamp's.
struct CosineLightDescription {
    using Light = CosineLight;
    static constexpr const char* kName = "cosine";

    Vec3d position, direction;  // world
    Rgb intensity;              // along the direction, W/sr
    std::string name;

    bool isDark() const { return isBlack(intensity); }
};

struct CosineLight {
    static constexpr LightPlace kPlace = LightPlace::kAtPoint;
    static constexpr bool kIsEven = false;

    Vec3d position;
    Rgb intensity;
    Vec3f axis;

    CosineLight(const CosineLightDescription& from, const SceneBox& box)
        : position(from.position - box.centre),
          intensity(from.intensity),
          axis(normalize(from.direction)) {}

    static double powerMean(const CosineLightDescription& from, const SceneBox&) {
        return std::numbers::pi * channelMean(from.intensity);
    }
    float falloff(const Vec3f& direction) const { return std::max(0.0f, dot(axis, direction)); }
    static float largestFalloff(const Vec3d&, double) { return 1.0f; }
    static float falloffIntegral() { return kPi; }
    DirectionCone cone() const { return {axis, 1.0f}; }
    Vec3f sampleFalloff(Vec2f u) const {
        return normalize(Frame(axis).toWorld(sampleCosineHemisphere(u)));
    }
    LightExtent extent() const { return {position, position, axis, false}; }
};

}  // namespace pm
