// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>

#include "integrator/lights/beam.h"
#include "integrator/lights/light_place.h"
#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

struct SpotLight;

// A light without area that shines into a cone.
struct SpotLightDescription {
    using Light = SpotLight;
    static constexpr const char* kName = "spot";

    Vec3d position;          // world
    Vec3d direction;         // world, in which light travels along the cone's middle; not 0
    Rgb intensity;           // W/sr, inside the part where it does not fade
    double coneAngle = 0.5;  // half of the whole cone's, radians, in (0, pi]
    double coneFalloff = 0;  // radians of it over which light fades, in [0, coneAngle]
    std::string name;

    bool isDark() const { return isBlack(intensity); }
};

struct SpotLight {
    static constexpr LightPlace kPlace = LightPlace::kAtPoint;
    static constexpr bool kIsEven = false;

    Vec3d position;
    Rgb intensity;
    Beam beam;

    SpotLight(const SpotLightDescription& from, const SceneBox& box)
        : position(from.position - box.centre),
          intensity(from.intensity),
          beam(Beam::make(from.direction, from.coneAngle, from.coneFalloff)) {}

    double powerMean(const SpotLightDescription& from, const SceneBox&) const {
        return static_cast<double>(beam.fluxOverIntensity()) * channelMean(from.intensity);
    }
    float falloff(const Vec3f& direction) const { return beam.intensity(direction); }
    float largestFalloff(const Vec3d& axis, double sine) const {
        return beam.largestIntensity(axis, sine);
    }
    float falloffIntegral() const { return beam.fluxOverIntensity(); }
    DirectionCone cone() const { return {beam.axis, beam.oneMinusCos}; }
    Vec3f sampleFalloff(Vec2f u) const {
        float pdf;
        return beam.sampleIntensity(u, pdf);
    }
    // As a lamp that faces along its axis, where its cone is no wider than such a lamp's.
    LightExtent extent() const {
        if (beam.oneMinusCos <= 1.0f) return {position, position, beam.axis, false};
        return {position, position, {}, true};
    }
};

}  // namespace pm
