// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/rays/ray_tracer.h"
#include "integrator/scene/light_choice.h"
#include "integrator/scene/scene.h"
#include "integrator/scene/surface.h"
#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

// A direction towards a light, chosen by next-event estimation.
struct LightSample {
    Vec3f direction;  // unit, from the surface to the light
    Rgb radiance;     // what arrives from there, W m^-2 sr^-1; of a point light: irradiance of a
                      // surface that faces it, W m^-2, to be divided by pdfSolidAngle all the same
    float pdfSolidAngle = 0.0f;  // sr^-1, the choice of the light included; of a point light that
                                 // choice's probability alone
    bool isPoint = false;        // no other strategy can find it
    Ray shadowRay;               // to be tested with Scene::occluded
};

// A photon as it leaves a light.
struct EmittedPhoton {
    Ray ray;
    Rgb flux;  // W, of one photon if only one were emitted: divide by the number emitted
};

// Chooses lights by power, with a floor so that none is starved, and points on them.
// Threads: const functions from any, at once.
class LightSampler {
  public:
    explicit LightSampler(const Scene& scene);

    bool empty() const { return m_choice.empty(); }

    // False when the chosen point can't shine on the surface.
    // u: of the light by its first number, of the point on it by both.
    bool sample(const Surface& surface, Vec2f u, LightSample& sample) const;

    // Density with which sample() at `from` finds the point `onLight` (whose primitive is a light)
    // along the unit direction `direction`; sr^-1.
    float pdfSolidAngle(const Surface& from, const Vec3f& direction, const Surface& onLight) const;

    // A photon: light by power, point uniform over its area, direction by the cosine; of a point
    // light outside the scene, towards the sphere around it, and with the flux of that cone. False
    // when it carries nothing.
    bool emit(float uLight, Vec2f uPoint, Vec2f uDirection, EmittedPhoton& photon) const;

    // The cone that photons of a point light fill: from outside the scene only the one that holds
    // all of it is worth a photon, the rest of the light's flux would escape; else all directions.
    void pointLightCone(const Light& light, Vec3f& axis, float& oneMinusCos) const;

    // Radiance that leaves a point of the scene along the unit direction: emission of its front.
    Rgb emittedRadiance(const Surface& surface, const Vec3f& direction) const;
    // The same of a point that is known to be on a light, in any direction on its front.
    Rgb frontRadiance(const Surface& surface) const;

  private:
    bool sampleTriangle(const Surface& surface, const Light& light, float probability, Vec2f u,
                        LightSample& sample) const;
    bool sampleSphere(const Surface& surface, const Light& light, float probability, Vec2f u,
                      LightSample& sample) const;
    bool samplePoint(const Surface& surface, const Light& light, float probability,
                     LightSample& sample) const;

    bool emitFromPoint(const Light& light, float probability, Vec2f u, EmittedPhoton& photon) const;

    const Scene& m_scene;
    LightChoice m_choice;
};

}  // namespace pm
