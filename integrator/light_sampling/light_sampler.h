// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "integrator/light_sampling/light_choice.h"
#include "integrator/light_sampling/light_guide.h"
#include "integrator/light_sampling/light_tree.h"
#include "integrator/light_sampling/sky_guide.h"
#include "integrator/lights/light_sample.h"
#include "integrator/rays/ray_tracer.h"
#include "integrator/scene/scene.h"
#include "integrator/shapes/surface.h"
#include "integrator/values/cancel_check.h"
#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

// A light to be sampled at a surface.
struct ChosenLight {
    Vec2f u;  // random numbers, for the point on it
    std::uint32_t light = 0;
    float probability = 0.0f;  // of the choice
};

// A photon as it leaves a light.
struct EmittedPhoton {
    Ray ray;
    Rgb flux;           // W, of one photon if only one were emitted: divide by the number emitted
    bool isMet = true;  // the light, by rays
    std::uint32_t light = 0;  // of the scene's, or of its lamps' triangles
};

// A place where light is asked for, and any direction on the side of the surface that is lit.
struct LitPlace {
    Surface surface;
    Vec3f side;
};

// Chooses lights and points on them. Few lights are chosen by power, with a floor so that none is
// starved; of many (isGuided()) each receiver has its own choice, by a LightTree and, once learn()
// was called, a LightGuide; those infinitely far are chosen beside it, by power. Directions of an
// environment that is mostly hidden are chosen by a SkyGuide, once learn() was called. Photons
// leave lights by power. Threads: const functions from any, at once.
class LightSampler {
  public:
    // Of many lights in parallel in the calling TBB arena. Throws Error(kCancelled) soon after
    // cancel is set.
    explicit LightSampler(const Scene& scene, const CancelCheck& cancel = {});
    // For photons, aimed or not, and for pilots: by power alone; takes next to no time.
    static LightSampler forPhotons(const Scene& scene);

    // More lights than this, those infinitely far not counted, are many.
    static constexpr std::size_t kFewLights = 16;

    bool empty() const { return m_choice.empty(); }
    bool isGuided() const { return m_tree != nullptr; }
    // There is something to learn: many lights, or an environment that may be hidden.
    bool learns() const { return isGuided() || m_scene.hasEnvironment(); }

    // Learns by shadow rays which lights reach `places`, the places where most samples will be
    // asked for; and, where most of the environment is hidden from them, where it is not. Nothing
    // happens without many lights or an environment, or without places. A function of scene, places
    // and seed; works in parallel in the calling TBB arena. Throws Error(kCancelled) soon after
    // cancel is set; then this must not be used any more.
    void learn(std::span<const LitPlace> places, std::uint64_t seed,
               const CancelCheck& cancel = {});

    // Chooses a light for each `chosen` by the first number of its u, in [0, 1)^2, which then says
    // where in the light's share it lay. Several of a surface take less time together.
    // side: any direction on the side of the surface that is lit.
    void choose(const Surface& surface, const Vec3f& side, std::span<ChosenLight> chosen) const;
    // A point on the light that choose() chose for the surface. False when it can't shine there.
    bool sample(const ChosenLight& chosen, const Surface& surface, LightSample& sample) const;

    // Both. False when the chosen point can't shine on the surface.
    // side: any direction on the side of the surface that is lit; without it, the front.
    // u: of the light by its first number, of the point on it by both.
    bool sample(const Surface& surface, const Vec3f& side, Vec2f u, LightSample& sample) const;
    bool sample(const Surface& surface, Vec2f u, LightSample& sample) const {
        return this->sample(surface, surface.geometricNormal, u, sample);
    }

    // Density with which sample() at `from`, of the side of `direction`, finds the point `onLight`
    // (whose primitive is a light) along the unit direction `direction`; sr^-1.
    float pdfSolidAngle(const Surface& from, const Vec3f& direction, const Surface& onLight) const;

    // The same of the far light of that number in Scene::farLights(), where a ray from there meets
    // nothing; 0 of parallel light.
    float farPdfSolidAngle(const Surface& from, const Vec3f& direction, std::size_t far) const;

    // A photon: light by power, point uniform over its area or by what its texture shows, direction
    // by the cosine; of a spot, by its intensity. Of a point or spot outside the scene, where that
    // is less, towards the sphere around the scene, and with the flux of that cone. Of what is
    // infinitely far, direction first, by radiance, then a point of the scene's box as seen from
    // there. False when it carries nothing.
    bool emit(float uLight, Vec2f uPoint, Vec2f uDirection, EmittedPhoton& photon) const;

    // The cone that photons of a point light or spot fill: all directions in which it shines, or
    // from outside the scene, where that is less, the cone that holds all of the scene: the rest of
    // the light's flux would escape.
    DirectionCone emissionCone(const Light& light) const;

    // A photon of a far light that goes through a point of the scene: it starts outside, or near
    // the core.
    Ray parallelRay(const Vec3d& through, const Vec3f& direction) const;

    // Radiance that leaves a point of the scene along the unit direction: emission of its front.
    Rgb emittedRadiance(const Surface& surface, const Vec3f& direction) const;
    // The same of a point that is known to be on a light, in any direction on its front.
    Rgb frontRadiance(const Surface& surface) const;

    // Of the tree and what was learnt.
    std::uint64_t memoryBytes() const;

  private:
    // But for the shadow ray's time.
    bool sampleOf(const ChosenLight& chosen, const Surface& surface, LightSample& sample) const;
    LightSampler(const Scene& scene, LightChoice choice);
    static Receiver receiverAt(const Surface& surface, const Vec3f& side);

    // Of up to kMost lights.
    template <std::size_t kMost>
    void chooseGuided(const Receiver& receiver, std::span<ChosenLight> chosen) const;
    float probability(const Surface& surface, const Vec3f& side, std::uint32_t light) const;
    void learnLights(std::span<const LitPlace> places, std::span<const Receiver> receivers,
                     std::uint64_t key, const CancelCheck& cancel);
    void learnSky(std::span<const LitPlace> places, std::span<const Receiver> receivers,
                  std::uint64_t key, const CancelCheck& cancel);
    float lookAtSky(const LitPlace& place, const Receiver& receiver, const Vec3f& direction) const;
    bool isSkyHidden(std::span<const LitPlace> places, std::span<const Receiver> receivers,
                     std::uint64_t key) const;
    std::vector<Sighting> look(std::span<const LitPlace> places, std::uint64_t key,
                               const CancelCheck& cancel) const;
    std::optional<Sighting> lookFrom(const LitPlace& place, std::uint32_t node, Vec2f u) const;
    bool emitFromPoint(const Light& light, float probability, Vec2f u, EmittedPhoton& photon) const;
    bool emitFromAfar(const Light& light, float probability, Vec2f uPoint, Vec2f uDirection,
                      EmittedPhoton& photon) const;

    const Scene& m_scene;
    LightChoice m_choice;  // of all lights
    // Beside the tree: of the lights that are infinitely far, and the share of choices for them.
    LightChoice m_farChoice;
    float m_farShare = 0.0f;
    std::unique_ptr<LightTree> m_tree;  // of many lights
    std::unique_ptr<const LightGuide> m_guide;
    std::unique_ptr<const SkyGuide> m_skyGuide;  // where most of the environment is hidden
};

}  // namespace pm
