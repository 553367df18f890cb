// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/path/path_integrator.h"

#include "integrator/transport/path/camera_step.h"

namespace pm {

namespace {

// One lobe at a time, and at each surface the light of lamps.
class ReferencePath {
  public:
    struct Step : CameraStep {
        using CameraStep::CameraStep;
        PathState state{};
        LastScatter last{};
    };
    static constexpr Transport kTransport = Transport::kRadiance;

    ReferencePath(const Scene& scene, const LightSampler& lights, SampleRadiance& result)
        : m_scene(scene), m_lights(lights), m_result(result) {}

    static CacheUser user(const Step& step) { return step.user(); }
    void setOut(const Step&) { ++m_result.rays; }
    void meetNothing(const Step& step) {
        m_result.of(step.state.classify()) +=
            step.carried * weightedFarLight(m_scene, m_lights, step.last);
    }
    Verdict meet(const Step& step, const Surface& surface) {
        m_result.of(step.state.classify()) +=
            step.carried * weightedEmission(m_lights, surface, step.last);
        return Verdict::kScatter;
    }
    bool scatter(Step& step, const Surface& surface, const Bsdf& bsdf, Waiting<Step>&) {
        recordFirstHit(surface, bsdf, m_result);
        if (bsdf.isBlackBody()) return false;
        if (bsdf.reflectsLamps()) addDirect(step, surface, bsdf);
        BsdfSample sample;
        if (!sampleLobe(bsdf, step.random, sample)) return false;
        if (!step.scatter(surface, bsdf, sample)) {
            if (step.isCut()) m_result.addCut(step.amount());
            return false;
        }
        step.state.scatter(sample.lobe, bsdf.isFrosted());
        if (sample.lobe == Lobe::kStraight) return true;
        step.last = lastScatter(surface, sample);
        if (m_scene.viewersDiffer() && !isDelta(sample.lobe)) {
            m_result.of(step.state.classify()) +=
                step.carried * lightAlong(m_scene, m_lights, step.ray, step.last, m_result.rays);
            step.last.hasLamps = true;
        }
        return true;
    }

  private:
    void addDirect(const Step& step, const Surface& surface, const Bsdf& bsdf) {
        const DirectRadiance direct =
            estimateDirect(m_scene, m_lights, surface, bsdf, DirectStrategy::kBoth,
                           step.state.hasMetNoDiffuse(), 1, step.random, m_result.rays);
        addByLobes(direct, bsdf, step.state, [&](const PathState& state, const Rgb& light) {
            m_result.of(state.classify()) += step.carried * light;
        });
    }

    const Scene& m_scene;
    const LightSampler& m_lights;
    SampleRadiance& m_result;
};

}  // namespace

SampleRadiance PathIntegrator::sample(const Ray& ray, const Sampler& sampler,
                                      const RayFootprint& footprint) const {
    SampleRadiance result;
    ReferencePath::Step first(ray, footprint, sampler);
    first.last.direction = ray.direction;
    walk(m_scene, ReferencePath(m_scene, m_lights, result), first);
    return result;
}

}  // namespace pm
