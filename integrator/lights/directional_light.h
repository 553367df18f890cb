// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <numbers>
#include <string>

#include "integrator/lights/beam.h"
#include "integrator/lights/box_shadow.h"
#include "integrator/lights/light_place.h"
#include "integrator/lights/light_sample.h"
#include "integrator/sampling/warps.h"
#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

struct DirectionalLight;

// Light from infinitely far: parallel, or from an even disc.
struct DirectionalLightDescription {
    using Light = DirectionalLight;
    static constexpr const char* kName = "directional";

    Vec3d direction;           // world, in which light travels from the disc's middle; not 0
    Rgb irradiance;            // W m^-2, of a surface that faces it
    double angularRadius = 0;  // of the disc, radians, in [0, pi/2]; next to 0 is parallel light
    std::string name;

    bool isDark() const { return isBlack(irradiance); }
};

struct DirectionalLight {
    static constexpr LightPlace kPlace = LightPlace::kFar;
    // A disc narrower than this (radians) shines along one direction: directions as floats could
    // not tell its edge.
    static constexpr double kNarrowestDisc = 1e-4;

    Beam beam;
    Rgb radiance;  // W m^-2 sr^-1; of parallel light its irradiance, W m^-2

    DirectionalLight(const DirectionalLightDescription& from, const SceneBox&)
        : beam(Beam::make(from.direction,
                          from.angularRadius < kNarrowestDisc ? 0.0 : from.angularRadius, 0.0)),
          radiance(from.irradiance) {
        // The irradiance of a disc of radiance L: pi L sin^2.
        if (isMet())
            radiance = from.irradiance /
                       (std::numbers::pi_v<float> * beam.oneMinusCos * (2.0f - beam.oneMinusCos));
    }

    double powerMean(const DirectionalLightDescription& from, const SceneBox& box) const {
        return channelMean(from.irradiance) * crossSection(box.halfSize, Vec3d(beam.axis));
    }
    bool isMet() const { return !beam.isDelta(); }
    Rgb radianceAlong(const Vec3f& direction) const {
        return isMet() && beam.holds(-direction) ? radiance : Rgb{};
    }
    FarLook look(Vec2f u) const {
        FarLook look{-beam.axis, radiance, 1.0f, beam.isDelta()};
        if (look.isParallel) return look;
        look.direction =
            normalize(Frame(look.direction).toWorld(sampleUniformCone(u, beam.oneMinusCos)));
        look.pdfSolidAngle = 1.0f / (2.0f * kPi * beam.oneMinusCos);
        return look;
    }
    float pdfSolidAngle(const Vec3f& direction, float probability) const {
        return isMet() && beam.holds(-direction) ? probability / (2.0f * kPi * beam.oneMinusCos)
                                                 : 0.0f;
    }
    bool emit(Vec2f u, ParallelLight& parallel) const {
        parallel = {beam.axis, radiance};
        if (beam.isDelta()) return true;
        parallel.direction =
            normalize(Frame(beam.axis).toWorld(sampleUniformCone(u, beam.oneMinusCos)));
        parallel.irradiance *= 2.0f * kPi * beam.oneMinusCos;
        return true;
    }
};

}  // namespace pm
