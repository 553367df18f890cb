// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/transport/path/camera_step.h"
#include "integrator/transport/path/direct_light.h"

namespace pm {

// A policy: light of lamps, straight or by way of delta lobes, and nothing that is scattered twice.
class DirectPath {
  public:
    using Step = CameraStep;
    static constexpr Transport kTransport = Transport::kRadiance;

    DirectPath(const Scene& scene, const LightSampler& lights) : m_scene(scene), m_lights(lights) {}

    static CacheUser user(const Step& step) { return step.user(); }
    void setOut(const Step&) { ++m_result.rays; }
    static void meetNothing(const Step&) {}
    Verdict meet(const Step& step, const Surface& surface) {
        if (surface.light != kNoLight)
            m_result.emission +=
                step.carried * m_lights.emittedRadiance(surface, -step.ray.direction);
        return Verdict::kScatter;
    }
    bool scatter(Step& step, const Surface& surface, const Bsdf& bsdf, Waiting<Step>&) {
        recordFirstHit(surface, bsdf, m_result);
        if (bsdf.isBlackBody()) return false;
        const DirectRadiance direct =
            estimateDirect(m_scene, m_lights, surface, bsdf, DirectStrategy::kNextEventOnly, true,
                           1, step.random, m_result.rays);
        m_result.direct += step.carried * (direct.of(Lobe::kDiffuse) + direct.shiny());
        BsdfSample sample;
        return sampleLobe(bsdf, step.random, sample) && isDelta(sample.lobe) &&
               step.scatter(surface, bsdf, sample);
    }
    const SampleRadiance& result() const { return m_result; }

  private:
    const Scene& m_scene;
    const LightSampler& m_lights;
    SampleRadiance m_result;
};

}  // namespace pm
