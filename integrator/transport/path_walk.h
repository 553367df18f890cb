// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/materials/bsdf.h"
#include "integrator/rays/ray_tracer.h"
#include "integrator/sampling/sampler.h"
#include "integrator/scene/surface.h"
#include "integrator/values/rgb.h"

namespace pm {

// A path from the camera on its way from surface to surface: the ray to follow next and what light
// found along it counts for.
struct PathWalk {
    Ray ray;
    Rgb throughput{1.0f};

    explicit PathWalk(const Ray& first) : ray(first) {}

    // Goes on along a sampled direction, by Russian roulette after the first events. False: the
    // path ends here. No random number is drawn where the path is sure to go on.
    bool scatter(const Surface& surface, const Bsdf& bsdf, const BsdfSample& sample,
                 Sampler& sampler);

  private:
    int m_events = 0;
    // Undoes the factors eta^2 of refraction, which say nothing about what the path will bring.
    float m_etaScale = 1.0f;
};

}  // namespace pm
