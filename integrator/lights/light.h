// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "integrator/lights/beam.h"
#include "integrator/lights/light_description.h"
#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

// One emitting primitive, a point or a spot, in the scene's own coordinates; or what shines from
// infinitely far: a directional light, the environment.
struct Light {
    enum class Kind : std::uint8_t {
        kTriangle,
        kSphere,
        kPoint,
        kSpot,
        kDirectional,
        kEnvironment
    };
    Kind kind = Kind::kPoint;
    std::uint32_t shape = 0;
    std::uint32_t primitive = 0;
    std::uint32_t material = 0;
    std::uint32_t beam = 0;     // of a spot or directional light: its number in Scene::beams()
    std::int32_t texture = -1;  // its number in Scene::m_lampTextures; none: shines evenly
    float area = 0.0f;          // scene units squared
    Vec3d position;             // of a point light or spot
    Rgb intensity;         // of a point light or spot, W/sr; of a directional light with a disc its
                           // radiance, W m^-2 sr^-1, of parallel light its irradiance, W m^-2
    double powerMean = 0;  // W, mean of the channels, never 0 of a surface; of what is infinitely
                           // far, what enters the scene's box

    bool isFar() const { return kind >= Kind::kDirectional; }
    bool isAtPoint() const { return kind == Kind::kPoint || kind == Kind::kSpot; }
};

// A directional light whose disc is narrower than this (radians) shines along one direction:
// directions as floats could not tell its edge.
inline constexpr double kNarrowestDisc = 1e-4;

// Adds point lights and spots, black ones left out. centre: of the scene, world.
void addPointLights(std::span<const PointLightDescription> points,
                    std::span<const SpotLightDescription> spots, const Vec3d& centre,
                    std::vector<Light>& lights, std::vector<Beam>& beams);

// The same of directional lights. halfSize: of the scene's box.
void addDirectionalLights(std::span<const DirectionalLightDescription> suns, const Vec3d& halfSize,
                          std::vector<Light>& lights, std::vector<Beam>& beams);

// Area of the scene's box as parallel light sees it; at least something, so that the light of a
// flat scene seen from its edge still has some power.
double crossSection(const Vec3d& halfSize, const Vec3d& direction);

}  // namespace pm
