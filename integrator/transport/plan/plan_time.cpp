// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/plan/plan_time.h"

#include <algorithm>
#include <cmath>

#include "integrator/materials/material_description.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/frame/gather_count.h"

namespace pm {

namespace {

// Seconds, by the passes of pm_bench_plan_time's scenes.
constexpr double kRay = 0.24e-6, kRayPerDoubling = 0.021e-6;  // of the number of triangles
constexpr double kLookUps = 0.45e-6, kLookUpsOfCaustics = 1.05e-6;
constexpr double kSiteByPatch = 2e-6;
constexpr double kStored = 0.75e-6, kCaustic = 2.4e-6;

// What pilots find later, as a rule: lamp samples; rays in proportion to the plan's.
constexpr double kLampSamples = 5, kShadowRay = 0.5;
// Broad lobes: gather rays differ more, and so there are more of them, which also go on.
constexpr double kMoreRaysByBroad = 2, kLongerByBroad = 2, kRaysAlongBroad = 4;
constexpr double kDivided = 2;  // parts of a camera path at glass
constexpr double kRaysOfSite = 40;
// Sites on all surfaces, over the photons that land over those of an estimate: their cells are 0.6
// of an estimate's radius wide, and edges and bent surfaces have more of them.
constexpr double kSitesOfEstimate = 26;

struct Traits {
    bool divides = false, broad = false;
};

Traits findTraits(const Scene& scene) {
    Traits traits;
    for (const InstanceDescription& instance : scene.description().instances)
        for (const std::uint32_t index : instance.materials) {
            const MaterialTraits& m = scene.traits(index);
            if (m.isInvisible) continue;
            traits.divides |= m.transmits;
            traits.broad |= m.hasBroadNumbers;
        }
    return traits;
}

// Of the gather points of a frame's pixels and the sites that they read.
double secondsOfGathering(const Scene& scene, const RenderSettings& settings, const Plan& plan,
                          const Traits& traits, double ray) {
    const auto pixels = static_cast<double>(settings.window.area());
    const double rays = gatherPointsOf(pixels, plan.gatherSpacing) * plan.gatherRays *
                        (traits.broad ? kMoreRaysByBroad : 1);
    const double discs = static_cast<double>(plan.globalLandings() + plan.descendedLandings()) /
                         settings.estimatePhotons;
    // Many rays meet the same sites.
    const double all = kSitesOfEstimate * discs;
    const double sites = rays * all / (rays + all);
    // Triangles smaller than an estimate's disc, as PhotonPass::patchesOfSites asks.
    const bool byPatch = static_cast<double>(scene.triangleCount()) < discs;
    return rays * 1.5 * ray * (traits.broad ? kLongerByBroad : 1) +
           sites * (byPatch ? kSiteByPatch : kRaysOfSite * ray);
}

}  // namespace

double secondsOfPass(const Scene& scene, const RenderSettings& settings, const Plan& plan) {
    const Traits traits = findTraits(scene);
    const double ray =
        kRay + kRayPerDoubling * std::log2(1.0 + static_cast<double>(scene.triangleCount()));
    const double lampSamples = plan.lampSamples > 0 ? plan.lampSamples : kLampSamples;
    double sample = ray * (1 + kShadowRay * lampSamples) + kLookUps;
    if (plan.causticMap) sample += kLookUpsOfCaustics;
    if (plan.receivedMap) sample += kLookUpsOfCaustics;
    if (traits.broad) sample += kRaysAlongBroad * ray;
    if (traits.divides) sample *= kDivided;
    const double samples = static_cast<double>(settings.window.area()) *
                           std::pow(4.0, static_cast<double>(settings.aaLevel) - 2.0);
    double seconds = samples * sample;
    if (plan.globalMap) seconds += secondsOfGathering(scene, settings, plan, traits, ray);
    return seconds + static_cast<double>(plan.globalLandings()) * (ray + kStored) +
           static_cast<double>(plan.causticPhotons) * (kCaustic + 2 * ray);
}

}  // namespace pm
