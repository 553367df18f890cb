// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/photons/estimate/irradiance_sites.h"
#include "integrator/sampling/sampler.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/gather/virtual_lamps.h"
#include "integrator/transport/path/direct_light.h"

namespace pm {

// What gather rays read where they end.
struct GatherEnds {
    const IrradianceSites& sites;
    // Light that caustics send straight to where the rays come from, where it is gathered; may be
    // null. rays: of the place, by which VirtualLamps weighs.
    const VirtualLamps* caustics = nullptr;
    std::uint32_t rays = 1;
    // By which light that reaches a broad lobe straight from a lamp is found; null: it is not.
    const LightSampler* lights = nullptr;
    // The ray leaves by a broad lobe of what the camera sees, and nothing else looks for what it is
    // to find: by way of other lobes all light of lamps and caustics, too.
    bool findsAll = false;
    // What sent the ray out, where light of lamps that it meets at once is asked for as well.
    const LastScatter* from = nullptr;
    float width = 0.0f;  // of the footprint that the ray starts from, scene units
    // By way of all lobes light of caustics is asked for; else by way of broad ones alone, and
    // SurfaceEstimates have the rest.
    bool findsRefocused = false;
    // But for light of lamps by way of other lobes than broad ones: a ReceivedMap has it.
    bool withoutCaustics = false;
};

// What one final-gather ray brings.
struct Gathered {
    TwoRadii radiance;  // light that left a diffuse surface, met at once or by way of other lobes,
                        // or a lamp, by way of broad ones
    Rgb lampsStraight;  // of lamps that are met at once, weighted; see GatherEnds::from
    Surface first;      // what the ray met first
    bool hitAny = false;  // `first` is valid
    std::uint32_t rays = 0;
    // Where the way ends, the irradiance that is still to be looked up, and the share of it that
    // is brought, sr^-1.
    bool isWaiting = false;
    Vec3f position, normal;
    Rgb reflected;
    // Of rays by the cosine, for each unit of area where the way ends at once; 0 where other lobes
    // come in between, by way of which caustics are not looked at. Scene units^-2.
    float density = 0.0f;
    bool readsCaustics = false;  // all of their light there

    void scale(float factor) {
        radiance.wide *= factor;
        radiance.narrow *= factor;
        reflected *= factor;
    }
};

// Follows a gather ray to the diffuse surfaces where the irradiance sites end it. Light that it
// finds at a lamp is in `radiance` where the lobe before is a broad one, there also sampled. Met at
// once, itself or straight on through what lets it pass, it is direct light; by way of a mirror,
// glass or a narrow lobe a caustic. That of caustics met by way of such lobes is refocused, and may
// have an estimate of its own. Source: Jensen 2001, section 9.2.
//
// In two steps: the first asks for the site at the end to be at hand soon, the second reads it.
// With another ray's first step between them memory has the time that it takes.
//
// cosine: of the ray to the shading normal where it comes from. sampler: at the event where it
// ends.
Gathered followGather(const Scene& scene, const GatherEnds& ends, const Ray& ray, float cosine,
                      const Sampler& sampler);
void endGather(const GatherEnds& ends, Gathered& gathered);

// Both.
Gathered finalGather(const Scene& scene, const GatherEnds& ends, const Ray& ray, float cosine,
                     const Sampler& sampler);

}  // namespace pm
