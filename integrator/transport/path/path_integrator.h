// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/sampling/sampler.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/path/direct_light.h"
#include "integrator/values/ray.h"

namespace pm {

// The unbiased reference: a path tracer with next-event estimation, weighted against sampling the
// BSDF by the power heuristic. Covers all light but that of point lights by way of mirrors and
// glass. Source: Kajiya 1986; Veach 1997, chapter 9. Threads: any, at once.
class PathIntegrator {
  public:
    PathIntegrator(const Scene& scene, const LightSampler& lights)
        : m_scene(scene), m_lights(lights) {}

    // footprint: of the ray.
    SampleRadiance sample(const Ray& ray, const Sampler& sampler,
                          const RayFootprint& footprint = {}) const;

  private:
    const Scene& m_scene;
    const LightSampler& m_lights;
};

}  // namespace pm
