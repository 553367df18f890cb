// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <string>

#include "integrator/materials/texture_source.h"
#include "integrator/values/rgb.h"
#include "integrator/values/transform.h"
#include "integrator/values/vec.h"

namespace pm {

// A light without area that shines equally in all directions.
struct PointLightDescription {
    Vec3d position;  // world
    Rgb intensity;   // W/sr
    std::string name;
};

// A light without area that shines into a cone.
struct SpotLightDescription {
    Vec3d position;          // world
    Vec3d direction;         // world, in which light travels along the cone's middle; not 0
    Rgb intensity;           // W/sr, inside the part where it does not fade
    double coneAngle = 0.5;  // half of the whole cone's, radians, in (0, pi]
    double coneFalloff = 0;  // radians of it over which light fades, in [0, coneAngle]
    std::string name;
};

// Light from infinitely far: parallel, or from an even disc.
struct DirectionalLightDescription {
    Vec3d direction;           // world, in which light travels from the disc's middle; not 0
    Rgb irradiance;            // W m^-2, of a surface that faces it
    double angularRadius = 0;  // of the disc, radians, in [0, pi/2]; next to 0 is parallel light
    std::string name;
};

// Light from infinitely far all around. See Environment for the picture's directions.
struct EnvironmentDescription {
    Rgb radiance;  // W m^-2 sr^-1; times the texture where there is one
    std::int32_t texture = kNoTexture;
    Transform toWorld = kIdentityTransform;  // a rotation; its translation means nothing
};

}  // namespace pm
