// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/shapes/surface.h"
#include "integrator/values/ray.h"
#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

// A direction towards a light, chosen by next-event estimation.
struct LightSample {
    Vec3f direction;  // unit, from the surface to the light
    Rgb radiance;     // what arrives from there, W m^-2 sr^-1; of a point: irradiance of a surface
                      // that faces it, W m^-2, to be divided by pdfSolidAngle all the same
    float pdfSolidAngle = 0.0f;  // sr^-1, the choice of the light included; of a point that
                                 // choice's probability alone
    bool isPoint = false;        // point light, spot, parallel light: no other strategy can find it
    Ray shadowRay;               // to be tested with Scene::occluded
};

// Light that comes from infinitely far along one direction.
struct ParallelLight {
    Vec3f direction;  // unit, the way that it travels
    Rgb irradiance;   // of a surface that faces it, over the density of the direction; W m^-2
};

// A direction in which light from infinitely far is seen.
struct FarLook {
    Vec3f direction;             // unit, towards the light
    Rgb radiance;                // W m^-2 sr^-1; of parallel light its irradiance, W m^-2
    float pdfSolidAngle = 1.0f;  // sr^-1; of parallel light 1
    bool isParallel = false;     // the only direction that there is
};

// The sample of such a look from a surface. probability: of the light's choice. False: it is black.
inline bool sampleFar(const FarLook& look, const Surface& from, float probability,
                      LightSample& sample) {
    sample.direction = look.direction;
    sample.radiance = look.radiance;
    sample.isPoint = look.isParallel;
    sample.pdfSolidAngle = probability * look.pdfSolidAngle;
    sample.shadowRay = rayFrom(from, sample.direction);
    return !isBlack(sample.radiance);
}

}  // namespace pm
