// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/plan/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/photons/emission/caustic_casters.h"
#include "integrator/photons/estimate/caustic_map.h"
#include "integrator/photons/trace/photon_tracer.h"
#include "integrator/scene/convex_body.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/plan/plan_memory.h"
#include "integrator/transport/plan/plan_time.h"
#include "integrator/transport/survey/caustic_reach.h"
#include "integrator/transport/survey/error_scale_pilot.h"
#include "integrator/transport/survey/lamp_samples.h"
#include "integrator/transport/survey/landing_pilot.h"

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
// Of the caustic photons: they are then as many as the global ones, unless told otherwise.
constexpr float kAutoDescent = 0.2f;
// Landings of a photon: 1/(1 - albedo) for an albedo of 0.75. Frames have photons by these.
constexpr double kExpectedLandings = 4;
// Where photons land more often than this, in the mean, chains of landings are traced in place of
// so many photons (LongChains): of about as many landings as twice this.
constexpr double kMostLandings = 16;
// Of caustic photons, those that the caustics send on by way of other lobes; at most as a rule.
constexpr double kExpectedRefocused = 0.5;

// Frames of so many pixels go bucket by bucket nearly everywhere, with the maps of up to 8 passes:
// those may take this. By the frame alone: not by the memory there is, nor the number of passes,
// which change no picture.
constexpr double kHugeFramePixels = 0x1p28;
constexpr std::uint32_t kPassesOfHugeFrame = 8;
constexpr std::uint64_t kMapBytesOfHugeFrame = std::uint64_t{560} << 20;

struct SceneTraits {
    bool diffuse = false;   // some surface reflects diffusely
    bool specular = false;  // some surface has another lobe that may cast caustics
    bool glossy = false;    // or a glossy lobe, broad or not
    bool wide = false;      // that may be wide
    bool delta = false;     // some surface may cast caustics by a delta lobe
    bool lights = false;
    bool pointLights = false;  // of those that no ray meets: point lights, spots, parallel light
    bool farLights = false;    // of those that rays meet
};

SceneTraits findTraits(const Scene& scene) {
    SceneTraits traits;
    for (const InstanceDescription& instance : scene.description().instances)
        for (const std::uint32_t index : instance.materials) {
            const MaterialTraits& m = scene.traits(index);
            traits.diffuse |= m.isDiffuse;
            traits.glossy |= m.isGlossy;
            traits.wide |= m.isWide;
            traits.specular |= m.castsCaustics;
            traits.delta |= m.castsCaustics && m.hasDelta;
        }
    traits.lights = !scene.lights().empty();
    for (const Light& light : scene.lights())
        (light.isMet() ? traits.farLights : traits.pointLights) |=
            light.isAtPoint() || light.isFar();
    return traits;
}

std::uint64_t photonsOf(const RenderSettings& settings, std::uint64_t ofSmallFrame) {
    if (settings.photons > 0) return settings.photons;
    // Of the frame, not the window: a crop has the same pixels.
    const double frames = static_cast<double>(settings.width) * settings.height / (256.0 * 256.0);
    return static_cast<std::uint64_t>(static_cast<double>(ofSmallFrame) *
                                      std::clamp(frames, kLeastOfThose, kMostOfThose));
}

// Memory at most; time of a sample from what each part took in rooms: the lamp samples' pilot
// weighs by it, and with it pictures would change.
void estimateCosts(const Scene& scene, const RenderSettings& settings, Plan& plan) {
    constexpr double kPerSample = 0.6e-6, kPerSampleOfCaustics = 0.9e-6, kPerGatherRay = 0.5e-6;
    constexpr double kPerGlobalPhoton = 3e-6, kPerCausticPhoton = 4e-6;
    const auto global = static_cast<double>(plan.globalPhotons);
    const auto caustic = static_cast<double>(plan.causticPhotons);
    estimateMemory(settings, plan);
    const double samplesOfAPixel = std::pow(4.0, static_cast<double>(settings.aaLevel) - 2.0);
    double perPixel =
        samplesOfAPixel * (kPerSample + (plan.causticMap ? kPerSampleOfCaustics : 0.0));
    if (plan.globalMap) {
        const double spacing = static_cast<double>(plan.gatherSpacing);
        perPixel += plan.gatherRays * kPerGatherRay / (spacing * spacing);
    }
    const double photons = global * kPerGlobalPhoton + caustic * kPerCausticPhoton;
    plan.processorSecondsPerPass = secondsOfPass(scene, settings, plan);
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
            "box, "
            "or by windows that a pilot finds where most of the sky is hidden");
    if (scene.lights().size() > LightSampler::kFewLights)
        plan.reasons.push_back(fmt::format(
            "lamps: {}, so each place has its own choice of them, by a tree and by which of them "
            "a few thousand places see",
            scene.lights().size()));
}

bool isHuge(const RenderSettings& settings) {
    return static_cast<double>(settings.width) * settings.height >= kHugeFramePixels;
}

// Fewer photons in huge frames, so that the maps of several passes fit into memory.
void limitPhotons(const RenderSettings& settings, Plan& plan) {
    if (!isHuge(settings) || settings.photons > 0) return;
    const auto bytes =
        static_cast<double>(plan.heldMapBytes(kPassesOfHugeFrame) + plan.buildingMapBytes());
    const double share = static_cast<double>(kMapBytesOfHugeFrame) / bytes;
    if (!(share < 1)) return;
    for (std::uint64_t* const photons : {&plan.globalPhotons, &plan.causticPhotons})
        *photons = static_cast<std::uint64_t>(static_cast<double>(*photons) * share);
    plan.reasons.push_back(fmt::format(
        "photons: in all {} a pass and no more, so that the maps of {} passes fit into {:.2f} GiB: "
        "a frame as large as this goes bucket by bucket; --photons asks for others",
        plan.photonsPerPass(), kPassesOfHugeFrame,
        static_cast<double>(kMapBytesOfHugeFrame) / (1 << 30)));
}

// In bright rooms few photons go on after they landed once: so many that all land about
// 2 kMostLandings times. A photon's chain has about 2 sqrt(4 n) stored landings where all land n
// times.
void planLandings(const Scene& scene, const RenderSettings& settings,
                  const std::atomic<bool>& cancelled, Plan& plan) {
    plan.landingsOfPhoton = kExpectedLandings;
    plan.causticLandingsOfPhoton = kCausticParts;
    plan.refocusedOfPhoton = kCausticParts * kExpectedRefocused;
    plan.receivedOfPhoton = kCausticParts;
    plan.descendedOfPhoton = kCausticParts * static_cast<double>(kAutoDescent) * kExpectedLandings +
                             plan.refocusedOfPhoton;
    const LandingPilot pilot = LandingPilot::of(scene, settings, cancelled);
    if (!(pilot.landings > kMostLandings)) return;
    const double oneIn = 2 * std::sqrt(4 * pilot.landings) / (2 * kMostLandings);
    plan.oneInChains = std::bit_floor(static_cast<std::uint32_t>(std::max(1.0, oneIn)));
    plan.landingsOfPhoton = 1 + pilot.storedInChains / plan.oneInChains;
    plan.reasons.push_back(fmt::format(
        "bright room: photons land {:.0f} times in the mean, so one in {} makes a long chain of "
        "landings, of which some are stored",
        pilot.landings, plan.oneInChains));
}

void planGlobalMap(const RenderSettings& settings, Plan& plan) {
    plan.gatherRaysByPilot = settings.gatherRays == 0;
    plan.gatherRays = plan.gatherRaysByPilot ? kAutoGatherRays : settings.gatherRays;
    plan.gatherSpacing = std::max(
        kGatherSpacing, static_cast<float>(std::sqrt(static_cast<double>(settings.width) *
                                                     settings.height / kMostGatherPoints)));
    plan.reasons.push_back(fmt::format(
        "indirect light: final gathering at a point for every {:.1f} x {:.1f} pixels, {} rays "
        "each{}, and the mean of the points near a sample",
        plan.gatherSpacing, plan.gatherSpacing, plan.gatherRays,
        plan.gatherRaysByPilot ? " or half, twice, four times as many, as a pilot finds, "
                                 "and half of them towards bright places where that pays"
                               : ""));
    plan.reasons.push_back(fmt::format(
        "global map: {} photons a pass, its irradiance kept at sites for what the gather rays "
        "meet; aimed at where those end, if the scene reaches far beyond, as a pilot finds",
        plan.globalPhotons));
}

void planCausticMap(const SceneTraits& traits, Plan& plan) {
    plan.reasons.push_back(fmt::format(
        "caustic map: {} photons a pass, {}", plan.causticPhotons,
        traits.specular ? "since the scene has surfaces that are not diffuse: aimed at those, and "
                          "where they reach far beyond what is seen, half of them at that, as a "
                          "pilot finds"
                        : "though every surface is diffuse"));
    if (!plan.globalMap) return;
    plan.reasons.push_back(fmt::format(
        "light descended from caustics: they are lamps to the gather points, which find them by "
        "rays to some of their photons, weighted against gather rays; what they send by way of "
        "other lobes has a density estimate, or is found by gather rays where a pilot finds little "
        "of it; {:.0f} % of their photons are followed on for the rest",
        plan.descent * 100.0f));
}

// Whether glossy and broad lobes receive caustics that nothing but photons finds well, or at all.
bool needsReceivedMap(const SceneTraits& traits) {
    return (traits.wide && traits.specular) ||
           (traits.glossy && traits.delta && traits.pointLights);
}

void explainReceivedMap(const SceneTraits& traits, Plan& plan) {
    if (traits.wide && traits.specular)
        plan.reasons.push_back(fmt::format(
            "caustics on glossy surfaces of roughness {:.2f} or more: by photons, which "
            "keep where they came from, as a ray along so wide a lobe seldom finds a "
            "lamp in a mirror or lens",
            LobeRoles{}.wideRoughness));
    if (traits.glossy && traits.delta && traits.pointLights)
        plan.reasons.push_back(
            "caustics of lights that no ray meets, on glossy surfaces of any roughness: by photons "
            "alone");
    if (traits.glossy && !traits.wide && traits.specular && !(traits.pointLights && traits.delta))
        plan.reasons.push_back(fmt::format(
            "caustics on glossy surfaces of roughness below {:.2f}: by rays along their "
            "lobes, which find lamps well",
            LobeRoles{}.wideRoughness));
}

// Why light goes from no surface to another; empty where it may.
std::string whyNothingGoesOn(const Scene& scene) {
    if (scene.isFlat()) return "all surfaces that reflect lie in one plane";
    if (isConvexBody(scene)) return "all that reflects is the outside of one convex body";
    return {};
}

// Why light casts no caustics; empty where it may. nothingGoesOn: whyNothingGoesOn().
std::string whyNoCaustics(const Scene& scene, const RenderSettings& settings,
                          const SceneTraits& traits, const std::string& nothingGoesOn,
                          const std::atomic<bool>& cancelled, Plan& plan) {
    if (!traits.specular)
        return traits.glossy ? "no lobe but diffuse ones and such as are too broad to cast "
                               "caustics carries more than a millionth"
                             : "every surface is diffuse";
    if (!nothingGoesOn.empty() || findsCaustics(scene, settings.seed, cancelled))
        return nothingGoesOn;
    plan.notices.push_back({NoticeCode::kNoCausticPhotons,
                            "0 photons reached a diffuse surface by way of another, so there is no "
                            "caustic light"});
    return fmt::format(
        "of {} photons aimed at surfaces that are not diffuse none was sent on by one",
        kCausticReachPhotons);
}

void planMaps(const Scene& scene, const RenderSettings& settings, const SceneTraits& traits,
              bool everything, const std::atomic<bool>& cancelled, Plan& plan) {
    const std::string nothingGoesOn = everything ? "" : whyNothingGoesOn(scene);
    const std::string noGlobalMap = traits.diffuse || everything || !nothingGoesOn.empty()
                                        ? nothingGoesOn
                                        : "no surface reflects diffusely";
    const std::string noCausticMap =
        everything ? "" : whyNoCaustics(scene, settings, traits, nothingGoesOn, cancelled, plan);
    plan.globalMap = noGlobalMap.empty();
    plan.causticMap = noCausticMap.empty();
    plan.tracePhotons = plan.globalMap || plan.causticMap;
    if (plan.globalMap) plan.globalPhotons = photonsOf(settings, kAutoGlobalPhotons);
    if (plan.causticMap) plan.causticPhotons = photonsOf(settings, kAutoCausticPhotons);
    if (plan.globalMap && plan.causticMap) plan.descent = kAutoDescent;
    plan.receivedMap = plan.causticMap && (everything || needsReceivedMap(traits));
    limitPhotons(settings, plan);
    if (plan.oneInChains > 0) plan.globalPhotons = LongChains::wholeNumber(plan.globalPhotons);
    if (plan.globalMap)
        planGlobalMap(settings, plan);
    else
        plan.reasons.push_back("no global map: " + noGlobalMap);
    if (plan.causticMap)
        planCausticMap(traits, plan);
    else
        plan.reasons.push_back("no caustic map: " + noCausticMap);
    if (plan.causticMap) explainReceivedMap(traits, plan);
}

void planErrorScale(const Scene& scene, const RenderSettings& settings,
                    const std::atomic<bool>& cancelled, Plan& plan) {
    const bool isTold = settings.errorScale.has_value();
    if (isTold)
        plan.errorScale = *settings.errorScale;
    else if (scene.description().camera)
        plan.errorScale = findErrorScale(scene, settings, CancelCheck(cancelled));
    plan.reasons.push_back(fmt::format(
        "error scale: {} stops, {}; errors are of values times 2^{}", plan.errorScale.stops(),
        isTold                         ? "as asked for"
        : plan.errorScale.stops() == 0 ? "as the picture is about as bright as a middle grey"
                                       : "which make the picture as bright as a middle grey",
        plan.errorScale.stops()));
}

Plan planLight(const Scene& scene, const RenderSettings& settings,
               const std::atomic<bool>& cancelled) {
    Plan plan;
    const SceneTraits traits = findTraits(scene);
    const bool isPath = settings.integrator != IntegratorKind::kPhoton;
    if (isPath && traits.glossy && traits.specular && traits.pointLights)
        plan.notices.push_back({NoticeCode::kNotCovered,
                                "light of point lights, spots and suns without a disc that reaches "
                                "a glossy lobe by way of a mirror, glass or another glossy surface "
                                "is not rendered"});
    if (settings.hasGroups())
        plan.notices.push_back({NoticeCode::kNotCovered,
                                "anti-aliasing begins at level 0: where 2 x 2 pixels share their "
                                "samples, the estimated error covers neither the blur nor what "
                                "few samples miss"});
    if (isPath) {
        planPaths(traits, plan);
        return plan;
    }
    const bool everything = settings.plan == PlanKind::kEverything;
    if (everything) plan.reasons.push_back("everything: asked for by --plan everything");
    if (!traits.lights && !everything) {
        plan.reasons.push_back("no photons: nothing emits");
        return plan;
    }
    if (!traits.diffuse && !everything && !needsReceivedMap(traits)) {
        plan.reasons.push_back("no photons: no surface reflects diffusely, paths are followed");
        return plan;
    }
    planDirectLight(scene, traits, plan);
    planLandings(scene, settings, cancelled, plan);
    planMaps(scene, settings, traits, everything, cancelled, plan);
    expectLandings(scene, settings, cancelled, plan);
    estimateCosts(scene, settings, plan);
    return plan;
}

}  // namespace

Plan makePlan(const Scene& scene, const RenderSettings& settings,
              const std::atomic<bool>& cancelled) {
    Plan plan = planLight(scene, settings, cancelled);
    planErrorScale(scene, settings, cancelled, plan);
    return plan;
}

Plan makePlan(const Scene& scene, const RenderSettings& settings) {
    return makePlan(scene, settings, std::atomic<bool>(false));
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
            "maps: at most about {:.2f} GiB at a time\ntime: about {:.2g} processor seconds a "
            "pass, to a factor of two\n",
            static_cast<double>(mapBytes) / (1 << 30), processorSecondsPerPass);
    return text;
}

}  // namespace pm
