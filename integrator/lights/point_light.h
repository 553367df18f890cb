// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <numbers>
#include <string>

#include "integrator/lights/light_place.h"
#include "integrator/sampling/warps.h"
#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

struct PointLight;

// A light without area that shines equally in all directions.
struct PointLightDescription {
    using Light = PointLight;
    static constexpr const char* kName = "point";

    Vec3d position;  // world
    Rgb intensity;   // W/sr
    std::string name;

    bool isDark() const { return isBlack(intensity); }
};

struct PointLight {
    static constexpr LightPlace kPlace = LightPlace::kAtPoint;
    static constexpr bool kIsEven = true;

    Vec3d position;
    Rgb intensity;

    PointLight(const PointLightDescription& from, const SceneBox& box)
        : position(from.position - box.centre), intensity(from.intensity) {}

    static double powerMean(const PointLightDescription& from, const SceneBox&) {
        return 4 * std::numbers::pi * channelMean(from.intensity);
    }
    static float falloff(const Vec3f&) { return 1.0f; }
    static float largestFalloff(const Vec3d&, double) { return 1.0f; }
    static float falloffIntegral() { return 4.0f * kPi; }
    static DirectionCone cone() { return {}; }
    static Vec3f sampleFalloff(Vec2f u) {
        const DirectionCone all;
        return normalize(Frame(all.axis).toWorld(sampleUniformCone(u, all.oneMinusCos)));
    }
    LightExtent extent() const { return {position, position, {}, true}; }
};

}  // namespace pm
