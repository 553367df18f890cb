// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "integrator/photons/caustic_casters.h"
#include "integrator/photons/caustic_map.h"
#include "integrator/photons/irradiance_sites.h"
#include "integrator/scene/light_sampler.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/gather_points.h"
#include "integrator/transport/lamp_samples.h"

namespace pm {

namespace {

// Photons a pass where nothing else is asked for, for a frame of 256 x 256 pixels. Others have more
// or fewer in proportion, so that photons take the same share of the time; see docs/decisions.md.
constexpr std::uint64_t kAutoGlobalPhotons = 30'000;
constexpr std::uint64_t kAutoCausticPhotons = 150'000;
constexpr double kLeastOfThose = 0.5, kMostOfThose = 16.0;
constexpr std::uint32_t kAutoGatherRays = 32;
// Gather points: one for 2.5 x 2.5 pixels, but no more than these in a frame.
constexpr float kGatherSpacing = 2.5f;
constexpr double kMostGatherPoints = 1 << 20;
constexpr float kAutoDescent = 1.0f;
// Arrivals a photon: 1/(1 - albedo) for an albedo of 0.75.
constexpr std::uint64_t kExpectedArrivals = 4;

struct SceneTraits {
    bool diffuse = false;   // some surface reflects diffusely
    bool specular = false;  // some surface has another lobe
    bool glossy = false;
    bool lights = false;
    bool pointLights = false;  // of those that no ray meets: point lights, spots, parallel light
    bool farLights = false;    // of those that rays meet
    bool flat = false;         // all in one plane: no light from surface to surface
};

SceneTraits findTraits(const Scene& scene) {
    SceneTraits traits;
    for (const InstanceDescription& instance : scene.description().instances)
        for (const std::uint32_t index : instance.materials) {
            const MaterialDescription& m = scene.material(index);
            const bool surface = m.kind == MaterialKind::kSurface;
            traits.diffuse |= surface && !isBlack(m.diffuse);
            const bool glossy = (surface && !isBlack(m.glossy)) ||
                                (m.kind == MaterialKind::kMirror && m.glossyExponent > 0.0f);
            traits.glossy |= glossy;
            traits.specular |= castsCaustics(m);
        }
    traits.lights = !scene.lights().empty();
    for (const Light& light : scene.lights())
        (scene.isMet(light) ? traits.farLights : traits.pointLights) |=
            light.isAtPoint() || light.isFar();
    traits.flat = scene.isFlat();
    return traits;
}

std::uint64_t photonsOf(const RenderSettings& settings, std::uint64_t ofSmallFrame) {
    if (settings.photons > 0) return settings.photons;
    // Of the frame, not the window: a crop has the same pixels.
    const double frames = static_cast<double>(settings.width) * settings.height / (256.0 * 256.0);
    return static_cast<std::uint64_t>(static_cast<double>(ofSmallFrame) *
                                      std::clamp(frames, kLeastOfThose, kMostOfThose));
}

// Memory at most; time from what each part took where docs/benchmarks.md was measured.
void estimateCosts(const RenderSettings& settings, Plan& plan) {
    constexpr double kPerSample = 0.6e-6, kPerSampleOfCaustics = 0.9e-6, kPerGatherRay = 0.5e-6;
    constexpr double kPerGlobalPhoton = 3e-6, kPerCausticPhoton = 4e-6;
    const auto global = static_cast<double>(plan.globalPhotons);
    const auto caustic = static_cast<double>(plan.causticPhotons);
    plan.mapBytes = plan.landingsPerPass() * PhotonMap::kBytesPerPhoton;
    const double samplesOfAPixel = std::pow(4.0, static_cast<double>(settings.aaLevel) - 2.0);
    double perPixel =
        samplesOfAPixel * (kPerSample + (plan.causticMap ? kPerSampleOfCaustics : 0.0));
    if (plan.globalMap) {
        plan.mapBytes +=
            GatherPoints::memoryBytes(settings.width, settings.height, plan.gatherSpacing) +
            IrradianceSites::memoryBytes(plan.globalPhotons * kExpectedArrivals);
        const double spacing = static_cast<double>(plan.gatherSpacing);
        perPixel += plan.gatherRays * kPerGatherRay / (spacing * spacing);
    }
    const double photons = global * kPerGlobalPhoton + caustic * kPerCausticPhoton;
    plan.processorSecondsPerPass = static_cast<double>(settings.window.area()) * perPixel + photons;
    const double framePixels = static_cast<double>(settings.width) * settings.height;
    plan.processorSecondsPerSample = (perPixel + photons / framePixels) / samplesOfAPixel;
}

void planPaths(const SceneTraits& traits, Plan& plan) {
    plan.reasons.push_back("path tracing: asked for by --integrator path; no photons");
    plan.lampSamples = 1;
    if (traits.specular && traits.diffuse && traits.pointLights)
        plan.notices.push_back({NoticeCode::kNotCovered,
                                "caustics of point lights, spots and suns without a disc can't "
                                "be found by path tracing"});
}

void planDirectLight(const Scene& scene, const SceneTraits& traits, Plan& plan) {
    plan.reasons.push_back(
        "direct light: next-event estimation, weighted against rays along the diffuse lobe where "
        "lamps fill much of the view");
    plan.reasons.push_back(
        fmt::format("lamp samples: 1 to {} at a camera sample's first surface, as many as a pilot "
                    "finds to pay",
                    kMostLampSamples));
    if (traits.farLights)
        plan.reasons.push_back(
            "light from afar: seen by rays that meet nothing; its photons enter by the scene's "
            "box");
    if (scene.lights().size() > LightSampler::kFewLights)
        plan.reasons.push_back(fmt::format(
            "lamps: {}, so each place has its own choice of them, by a tree and by which of them "
            "a few thousand places see",
            scene.lights().size()));
}

void planGlobalMap(const RenderSettings& settings, Plan& plan) {
    plan.globalPhotons = photonsOf(settings, kAutoGlobalPhotons);
    plan.gatherRaysByPilot = settings.gatherRays == 0;
    plan.gatherRays = plan.gatherRaysByPilot ? kAutoGatherRays : settings.gatherRays;
    plan.gatherSpacing = std::max(
        kGatherSpacing, static_cast<float>(std::sqrt(static_cast<double>(settings.width) *
                                                     settings.height / kMostGatherPoints)));
    plan.reasons.push_back(fmt::format(
        "indirect light: final gathering at a point for every {:.1f} x {:.1f} pixels, {} rays "
        "each{}, and the mean of the points near a sample",
        plan.gatherSpacing, plan.gatherSpacing, plan.gatherRays,
        plan.gatherRaysByPilot ? " or half, twice, four times as many, as a pilot finds" : ""));
    plan.reasons.push_back(fmt::format(
        "global map: {} photons a pass, its irradiance kept at sites for what the gather rays "
        "meet",
        plan.globalPhotons));
}

void planCausticMap(const RenderSettings& settings, const SceneTraits& traits, Plan& plan) {
    plan.causticPhotons = photonsOf(settings, kAutoCausticPhotons);
    plan.reasons.push_back(
        fmt::format("caustic map: {} photons a pass, aimed, {}", plan.causticPhotons,
                    traits.specular ? "since the scene has surfaces that are not diffuse"
                                    : "though every surface is diffuse"));
    if (!plan.globalMap) return;
    plan.descent = kAutoDescent;
    plan.reasons.push_back(fmt::format(
        "light descended from caustics: {:.0f} % of their photons are followed on, for a "
        "wide density estimate; gather rays would have to find the caustics",
        plan.descent * 100.0f));
}

void planMaps(const RenderSettings& settings, const SceneTraits& traits, bool everything,
              Plan& plan) {
    plan.globalMap = !traits.flat || everything;
    plan.causticMap = (traits.specular && !traits.flat) || everything;
    plan.tracePhotons = plan.globalMap || plan.causticMap;
    if (plan.globalMap)
        planGlobalMap(settings, plan);
    else
        plan.reasons.push_back("no global map: all surfaces that reflect lie in one plane");
    if (plan.causticMap)
        planCausticMap(settings, traits, plan);
    else
        plan.reasons.push_back(traits.specular
                                   ? "no caustic map: all surfaces that reflect lie in one plane"
                                   : "no caustic map: every surface is diffuse");
}

}  // namespace

Plan makePlan(const Scene& scene, const RenderSettings& settings) {
    Plan plan;
    const SceneTraits traits = findTraits(scene);
    if (traits.glossy && traits.pointLights)
        plan.notices.push_back({NoticeCode::kNotCovered,
                                "light of point lights, spots and suns without a disc that reaches "
                                "a glossy lobe by way of a mirror, glass or another glossy surface "
                                "is not rendered"});
    if (settings.hasGroups())
        plan.notices.push_back({NoticeCode::kNotCovered,
                                "anti-aliasing begins at level 0: where 2 x 2 pixels share their "
                                "samples, the estimated error covers neither the blur nor what "
                                "few samples miss"});
    if (settings.integrator == IntegratorKind::kPath) {
        planPaths(traits, plan);
        return plan;
    }
    const bool everything = settings.plan == PlanKind::kEverything;
    if (everything) plan.reasons.push_back("everything: asked for by --plan everything");
    if (!traits.lights && !everything) {
        plan.reasons.push_back("no photons: nothing emits");
        return plan;
    }
    if (!traits.diffuse && !everything) {
        plan.reasons.push_back("no photons: no surface reflects diffusely, paths are followed");
        return plan;
    }
    planDirectLight(scene, traits, plan);
    planMaps(settings, traits, everything, plan);
    estimateCosts(settings, plan);
    return plan;
}

std::uint64_t Plan::landingsPerPass() const {
    const double ofCaustic = 1.0 + static_cast<double>(descent) * kExpectedArrivals;
    return globalPhotons * kExpectedArrivals +
           static_cast<std::uint64_t>(static_cast<double>(causticPhotons) * ofCaustic);
}

std::uint64_t Plan::globalPilotPhotons() const {
    return globalPhotons / PilotRadius::kPilotShare + 1;
}

std::uint64_t Plan::causticPilotPhotons() const {
    return causticPhotons / PilotRadius::kPilotShare + 1;
}

std::uint64_t Plan::aimPilotPhotons() const {
    return causticPilotPhotons() / 4 + 1;
}

std::string Plan::explain() const {
    std::string text;
    for (const std::string& reason : reasons) text += reason + "\n";
    if (tracePhotons)
        text += fmt::format(
            "maps: at most about {:.1f} MB at a time\ntime: about {:.2g} processor seconds a "
            "pass, to a factor of two\n",
            static_cast<double>(mapBytes) / 1e6, processorSecondsPerPass);
    return text;
}

}  // namespace pm
