// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/gather/final_gather.h"

#include <algorithm>

#include "integrator/sampling/warps.h"
#include "integrator/transport/path/camera_step.h"
#include "integrator/transport/path/direct_light.h"

namespace pm {

namespace {

// Follows gather rays by the lobes that don't end them.
class GatherPath {
  public:
    struct Step : CameraStep {
        using CameraStep::CameraStep;
        LastScatter last{};
        bool atOnce = true, byBroadOnly = true;  // by no lobe yet; by no other one
    };
    static constexpr Transport kTransport = Transport::kRadiance;

    // ray: the first one.
    GatherPath(const Scene& scene, const GatherEnds& ends, const Ray& ray, float cosine,
               Gathered& result)
        : m_scene(scene), m_ends(ends), m_first(ray), m_cosine(cosine), m_result(result) {}

    static CacheUser user(const Step&) { return CacheUser::kGather; }
    void setOut(const Step&) { ++m_result.rays; }
    void meetNothing(const Step& step) { addLampsMet(step, nullptr); }
    Verdict meet(const Step& step, const Surface& surface) {
        addLampsMet(step, &surface);
        if (!m_result.hitAny) {
            m_result.first = surface;
            m_result.hitAny = true;
        }
        return Verdict::kScatter;
    }
    bool scatter(Step& step, const Surface& surface, const Bsdf& bsdf, Waiting<Step>&) {
        if (bsdf.isBlackBody()) return false;
        if (bsdf.has(Lobe::kDiffuse)) {
            setEnd(step, surface, bsdf);
            if (bsdf.isDiffuseOnly()) return false;
            endGather(m_ends, m_result);
        }
        addLampsSampled(step, surface, bsdf);
        BsdfSample sample;
        if (!sampleLobe(bsdf, step.random, sample) || sample.lobe == Lobe::kDiffuse ||
            !step.scatter(surface, bsdf, sample))
            return false;
        if (sample.lobe == Lobe::kStraight) return true;
        step.atOnce = false;
        step.last = lastScatter(surface, sample);
        if (m_scene.viewersDiffer() && !isDelta(sample.lobe) && isAsked(sample.lobe)) {
            add(step.carried *
                lightAlong(m_scene, *m_ends.lights, step.ray, step.last, m_result.rays));
            step.last.hasLamps = true;
        }
        step.byBroadOnly = step.byBroadOnly && sample.lobe == Lobe::kBroad;
        return true;
    }

  private:
    // Whether light of lamps that the last lobe leads to, or reflects, is the ray's business.
    bool isAsked(Lobe lobe) const {
        return m_ends.lights &&
               (lobe == Lobe::kBroad || (m_ends.findsAll && !m_ends.withoutCaustics));
    }
    void add(const Rgb& light) { m_result.radiance += {light, light}; }
    // met: null where the ray meets nothing.
    void addLampsMet(const Step& step, const Surface* met) {
        const auto light = [&](const LastScatter& last) {
            return step.carried * (met ? weightedEmission(*m_ends.lights, *met, last)
                                       : weightedFarLight(m_scene, *m_ends.lights, last));
        };
        if (step.atOnce) {
            if (m_ends.from) m_result.lampsStraight += light(*m_ends.from);
        } else if (isAsked(step.last.lobe)) {
            add(light(step.last));
        }
    }
    // By a sample of lamps, whether or not the lobe will be followed: else few rays would bring
    // much.
    void addLampsSampled(const Step& step, const Surface& surface, const Bsdf& bsdf) {
        const auto asked = [&](Lobe lobe) { return bsdf.has(lobe) && isAsked(lobe); };
        if (std::ranges::none_of(kShinyLobes, asked)) return;
        const DirectRadiance direct =
            estimateDirect(m_scene, *m_ends.lights, surface, bsdf, DirectStrategy::kNone, false, 1,
                           step.random, m_result.rays);
        Rgb sum;
        for (const Lobe lobe : kShinyLobes)
            if (asked(lobe)) sum += direct.of(lobe);
        add(step.carried * sum);
    }
    // The end of the way at a surface with a diffuse lobe, as endGather will read it.
    void setEnd(const Step& step, const Surface& surface, const Bsdf& bsdf) {
        Gathered& end = m_result;
        const VirtualLamps* caustics = m_ends.caustics;
        end.isWaiting = true;
        end.normal = bsdf.facingGeometricNormal();
        end.position = m_scene.pointUnderRay(surface.position, step.ray, end.normal);
        end.reflected = bsdf.reflectedOf(step.carried);
        end.density = 0.0f;
        end.readsCaustics =
            caustics &&
            (m_ends.findsAll || (!step.atOnce && (step.byBroadOnly || m_ends.findsRefocused)));
        if (caustics && step.atOnce && !m_ends.findsAll) {
            const float facing = -dot(step.ray.direction, end.normal);
            end.density =
                m_cosine * kInvPi * facing / lengthSquared(surface.position - m_first.origin);
        }
        if (end.density > 0.0f || end.readsCaustics) caustics->prefetch(end.position, end.normal);
        m_ends.sites.prefetch(end.position, end.normal);
    }

    const Scene& m_scene;
    const GatherEnds& m_ends;
    const Ray m_first;
    const float m_cosine;
    Gathered& m_result;
};

}  // namespace

Gathered followGather(const Scene& scene, const GatherEnds& ends, const Ray& ray, float cosine,
                      const Sampler& sampler) {
    Gathered result;
    walk(scene, GatherPath(scene, ends, ray, cosine, result),
         GatherPath::Step(ray, scene.coneAround(ray.direction, ends.width), sampler));
    return result;
}

void endGather(const GatherEnds& ends, Gathered& gathered) {
    if (!gathered.isWaiting) return;
    const CacheWatch::As as(CacheUser::kGather);
    gathered.isWaiting = false;
    TwoRadii irradiance = ends.sites.at(gathered.position, gathered.normal);
    if (gathered.density > 0.0f)
        irradiance += ends.caustics->gathered(gathered.position, gathered.normal, gathered.density,
                                              ends.rays);
    else if (gathered.readsCaustics)
        irradiance += ends.caustics->kept(gathered.position, gathered.normal);
    gathered.radiance +=
        {gathered.reflected * irradiance.wide, gathered.reflected * irradiance.narrow};
}

Gathered finalGather(const Scene& scene, const GatherEnds& ends, const Ray& ray, float cosine,
                     const Sampler& sampler) {
    Gathered result = followGather(scene, ends, ray, cosine, sampler);
    endGather(ends, result);
    return result;
}

}  // namespace pm
