// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "integrator/light_sampling/light_choice.h"
#include "integrator/light_sampling/light_sampler.h"
#include "integrator/photons/emission/aim_mixture.h"
#include "integrator/photons/emission/focus.h"
#include "integrator/photons/emission/sky_parts.h"
#include "integrator/scene/scene.h"
#include "integrator/values/cancel_check.h"

namespace pm {

// A photon as it leaves a light, and which choices made it.
struct AimedPhoton : EmittedPhoton {
    std::uint32_t caster = kNoCaster;
    std::uint32_t part = 0;  // of an environment's light: of the sky (SkyParts), where it is from
};

// What became of one photon of a pilot; flux in any unit, summed over the channels.
struct EmissionRecord {
    std::uint32_t light = 0;
    std::uint32_t caster = kNoCaster;
    float emitted = 0.0f;
    float landed = 0.0f;  // as caustic photons
    std::uint32_t part = 0;
};

// Emission of photons towards what can cast caustics: lights by the flux that they send to casters,
// points on lights by what they see of them, directions by AimMixture. Its expectation is
// LightSampler::emit's; what makes caustics comes many times as often, with as much less flux.
//
// The first guess is geometric; refine() learns from a pilot what is hidden. Lights are learned one
// by one, casters for each group of neighbouring lights, and parts of the sky; so memory and time
// grow with the number of lights, not with that times casters.
//
// A light without area is an EmissionPoint as it is. One without position chooses in the other
// order: a direction first, as unaimed or, of the environment once a pilot has told which parts of
// the sky reach casters, one of several of those; then a point in the shadows of casters, by
// AimShadows.
//
// Source (the idea): Jensen 1996, projection maps; here as one mixture over spheres.
// Threads: const functions from any, at once.
class AimedEmission {
  public:
    // Finds the casters. Into a caster that reaches far beyond what is seen, a ground of glass,
    // half of the photons go by way of balls around that. lights: of this scene; both must outlive
    // this. Runs in parallel in the calling TBB arena. Throws Error(kCancelled) soon after cancel
    // is set.
    AimedEmission(const Scene& scene, const LightSampler& lights, const Focus& seen = {},
                  const CancelCheck& cancel = {});

    // Emission of global photons towards a focus: the same with balls around it for casters, out to
    // where they hold the scene; there is nothing to refine.
    static AimedEmission atFocus(const Scene& scene, const LightSampler& lights, const Focus& focus,
                                 const CancelCheck& cancel = {});

    // Emission of global photons from infinitely far by way of balls, the windows of a room; other
    // lights emit as unaimed. seenShare: of each of SkyParts, how often it is seen through them.
    static AimedEmission atOpenings(const Scene& scene, const LightSampler& lights,
                                    std::vector<Caster> balls, std::span<const float> seenShare,
                                    const CancelCheck& cancel = {});

    // Nothing to aim from or at: emit() has no photon to give.
    bool empty() const { return m_casters.empty() || m_choice.empty(); }

    // Weighs lights and casters anew by the records of a pilot that was emitted by this object. The
    // same records in the same order give the same bits.
    void refine(std::span<const EmissionRecord> pilot);

    // False when the photon carries nothing. uChoice: of the light and of the caster.
    bool emit(Vec2f uChoice, Vec2f uPoint, Vec2f uDirection, AimedPhoton& photon) const;

    // Whether photons that leave a place should go by scatter(): far from the focus, where there is
    // one. What is far has few photons of much flux each; a bounce must not bring them near.
    bool scattersFrom(const Vec3f& position) const { return m_focus.levelAt(position) > 0; }
    // A direction towards the balls of the focus or, the unaimed share, by the cosine to `normal`
    // (unit); with the density of both, sr^-1. False when it has none.
    bool scatter(const Vec3f& position, const Vec3f& normal, float uChoice, Vec2f u,
                 Vec3f& direction, float& pdfSolidAngle) const;

    const Focus& focus() const { return m_focus; }
    std::span<const Caster> casters() const { return m_casters; }
    // Of a light's choice.
    float lightProbability(std::size_t light) const { return m_choice.probability(light); }
    const SkyParts& sky() const { return m_sky; }
    // Of a caster for a light: how much more its directions are worth than their solid angle.
    float worth(std::size_t light, std::size_t caster) const {
        return worthOf(static_cast<std::uint32_t>(light))[caster];
    }
    std::uint64_t memoryBytes() const;

  private:
    // A point on a light, what leaves it over the point's own density, and where a ray starts.
    struct Origin {
        EmissionPoint point;
        Rgb strength;  // W sr^-1: radiance times cosine (to come) over pdfArea, or intensity
        Vec3f rayStart;
    };

    struct Unaimed {};
    AimedEmission(const Scene& scene, const LightSampler& lights, Unaimed)
        : m_scene(scene), m_lights(lights) {}

    void addBalls(const Focus& seen, std::span<const EmissionPoint> viewpoints);
    void aimAtFocus(const CancelCheck& cancel);
    EmissionPoint viewpoint(std::uint32_t light, Vec2f uPoint) const;
    EmissionPoint pointLightView(const Light& light) const;
    EmissionPoint farView(const Light& light, Vec2f uDirection) const;
    double shareTowards(std::span<const Caster> casters, const EmissionPoint& point) const;
    double shareInShadows(std::span<const Caster> casters, const Light& light,
                          Vec2f uDirection) const;
    void refineSky(std::span<const EmissionRecord> pilot);
    bool emitParallel(const Light& light, float probability, float uCaster, Vec2f uPoint,
                      Vec2f uDirection, AimedPhoton& photon) const;
    Surface placeOnTexturedSphere(std::uint32_t light, const SphereShape& sphere, float& uCaster,
                                  Vec2f uPoint, float& pdfArea) const;
    void place(std::uint32_t light, float& uCaster, Vec2f uPoint, Origin& origin) const;
    double fluxTowards(std::span<const Caster> casters, std::uint32_t light) const;
    void groupLights(const CancelCheck& cancel);
    std::span<const float> worthOf(std::uint32_t light) const {
        return std::span(m_worth).subspan(m_group[light] * m_casters.size(), m_casters.size());
    }

    const Scene& m_scene;
    const LightSampler& m_lights;
    std::vector<Caster> m_casters;
    std::vector<double> m_prior;        // of each caster: its worth before anything is learned
    std::vector<std::uint8_t> m_group;  // of each light
    std::vector<float> m_worth;         // of each group and caster
    std::vector<double> m_guess;        // flux that each light sends to casters, unhidden, W
    SkyParts m_sky;
    LightChoice m_choice;
    Focus m_focus;
    float m_unaimedShare = AimMixture::kUnaimedShare;
    float m_unaimedShareOfNear = AimMixture::kUnaimedShare;  // of lights not infinitely far
};

}  // namespace pm
