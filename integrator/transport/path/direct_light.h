// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/materials/bsdf.h"
#include "integrator/paths/path_class.h"
#include "integrator/sampling/sampler.h"
#include "integrator/scene/scene.h"
#include "integrator/values/rgb.h"

namespace pm {

// Radiance of one camera sample by class, and what its first hit looks like.
struct SampleRadiance {
    Rgb emission, direct, caustic, indirect;
    Rgb biasProbe;          // what the density estimates at narrower radii would bring more
    float coverage = 0.0f;  // 1: something was hit
    Rgb albedo;
    Vec3f normal;
    Vec3f firstPosition;
    std::uint32_t firstShape = 0, firstMaterial = 0;
    std::uint32_t rays = 0;
    // Ended for their number of events, and what light found from there on would have counted for.
    std::uint32_t pathsCut = 0;
    float throughputCut = 0.0f;

    void addCut(float throughput) {
        ++pathsCut;
        throughputCut += throughput;
    }
    Rgb& of(PathClass c) {
        switch (c) {
            case PathClass::kEmission:
                return emission;
            case PathClass::kDirect:
                return direct;
            case PathClass::kCaustic:
                return caustic;
            default:
                return indirect;
        }
    }
};

// Radiance reflected by each lobe that is not delta, from lamps.
struct DirectRadiance {
    std::array<Rgb, 1 + kShinyLobes.size()> by;

    static_assert(static_cast<std::size_t>(Lobe::kDiffuse) == 0 &&
                  static_cast<std::size_t>(kShinyLobes.back()) == kShinyLobes.size());
    Rgb& of(Lobe lobe) { return by[static_cast<std::size_t>(lobe)]; }
    const Rgb& of(Lobe lobe) const { return by[static_cast<std::size_t>(lobe)]; }
    Rgb shiny() const {
        Rgb sum;
        for (const Lobe lobe : kShinyLobes) sum += of(lobe);
        return sum;
    }
};

// What lamps bring by each lobe of a surface: add(state, radiance), with the path's state after it.
template <typename Add>
void addByLobes(const DirectRadiance& direct, const Bsdf& bsdf, const PathState& state,
                const Add& add) {
    if (bsdf.has(Lobe::kDiffuse))
        add(state.after(Lobe::kDiffuse, false), direct.of(Lobe::kDiffuse));
    for (const Lobe lobe : kShinyLobes)
        if (bsdf.has(lobe)) add(state.after(lobe, bsdf.isFrosted()), direct.of(lobe));
}

// How light that a diffuse lobe receives straight from a lamp is found.
enum class DirectStrategy : std::uint8_t {
    kBoth,           // by next-event estimation and by sampling the lobe, weighted
    kNextEventOnly,  // where lamps fill so little of the view that sampling the lobe adds nothing
    kNone,           // it is not asked for
};

// Next-event estimation for both lobes: the mean of `samples` lamp samples, a power of two, with a
// shadow ray each; weighted against finding the same light by sampling the lobe once, for the
// diffuse lobe as `diffuse` says. isSeen: no diffuse lobe has been on the path so far; then coarse
// smooth meshes end in shadow where the surface that they stand for does, see smoothPoint(). Counts
// its rays in `rays`. Source: Veach 1997, section 9.2 (several samples of one strategy).
DirectRadiance estimateDirect(const Scene& scene, const LightSampler& lights,
                              const Surface& surface, const Bsdf& bsdf, DirectStrategy diffuse,
                              bool isSeen, std::uint32_t samples, const Sampler& sampler,
                              std::uint32_t& rays);

// The sample that led from one surface to the next, as far as the weight of light found there
// needs. What lets it go straight on between them does not count.
struct LastScatter {
    Surface from;
    Vec3f direction;
    Lobe lobe = Lobe::kStraight;
    float pdfSolidAngle = 0.0f;
    std::uint32_t lampSamples = 1;  // of next-event estimation at `from`
    bool hasLamps = false;          // what lamps are along it has been added: lightAlong()
};

// Of a sample of a surface's BSDF.
inline LastScatter lastScatter(const Surface& from, const BsdfSample& sample,
                               std::uint32_t lampSamples = 1) {
    return {from, sample.direction, sample.lobe, sample.pdfSolidAngle, lampSamples};
}

// Emission of `surface` towards the path that came by `last`, weighted against next-event
// estimation where that could have found it.
Rgb weightedEmission(const LightSampler& lights, const Surface& surface, const LastScatter& last);

// The same of lights that are infinitely far, where the path that came by `last` meets nothing.
Rgb weightedFarLight(const Scene& scene, const LightSampler& lights, const LastScatter& last);

// Light of lamps that the ray finds which `last` sent out, itself or straight on through what lets
// it pass, weighted as by both functions above. Nothing else is in its way than what is in a shadow
// ray's. Counts its rays.
Rgb lightAlong(const Scene& scene, const LightSampler& lights, const Ray& ray,
               const LastScatter& last, std::uint32_t& rays);

// First hit: albedo, normal, position, and which surface it is. What is wholly cut away there is
// passed over, as is every hit after the first.
void recordFirstHit(const Surface& surface, const Bsdf& bsdf, SampleRadiance& result);

}  // namespace pm
