// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "integrator/photons/caustic_map.h"
#include "integrator/scene/scene.h"

namespace pm {

namespace {

// Photons a pass where nothing else is asked for: at 50 to an estimate the Cornell box is then
// resolved to a hundredth of its width. Measured figures are in docs/benchmarks.md.
constexpr std::uint64_t kAutoGlobalPhotons = 200'000;
constexpr std::uint64_t kAutoCausticPhotons = 1'000'000;
// Irradiance is kept at one place for so many photons of the global map.
constexpr std::uint64_t kPhotonsPerSite = 2;
// Arrivals a photon: 1/(1 - albedo) for an albedo of 0.75.
constexpr std::uint64_t kExpectedArrivals = 4;

struct SceneTraits {
    bool diffuse = false;   // some surface reflects diffusely
    bool specular = false;  // some surface has another lobe
    bool glossy = false;
    bool lights = false;
    bool pointLights = false;
    bool flat = false;  // all in one plane: no light from surface to surface
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
            traits.specular |=
                !surface || glossy || m.transparency > 0.0f || m.opacityTexture != kNoTexture;
        }
    traits.lights = !scene.lights().empty();
    for (const Light& light : scene.lights())
        traits.pointLights |= light.kind == Light::Kind::kPoint;
    traits.flat = scene.isFlat();
    return traits;
}

}  // namespace

Plan makePlan(const Scene& scene, const RenderSettings& settings) {
    Plan plan;
    const SceneTraits traits = findTraits(scene);
    if (traits.glossy && traits.pointLights)
        plan.notices.push_back({NoticeCode::kNotCovered,
                                "light of point lights that reaches a glossy lobe by way of a "
                                "mirror, glass or another glossy surface is not rendered"});
    if (settings.integrator == IntegratorKind::kPath) {
        plan.reasons.push_back("path tracing: asked for by --integrator path; no photons");
        if (traits.specular && traits.diffuse && traits.pointLights)
            plan.notices.push_back({NoticeCode::kNotCovered,
                                    "caustics of point lights can't be found by path tracing"});
        return plan;
    }
    if (!traits.lights) {
        plan.reasons.push_back("no photons: nothing emits");
        return plan;
    }
    if (!traits.diffuse) {
        plan.reasons.push_back("no photons: no surface reflects diffusely, paths are followed");
        return plan;
    }
    plan.reasons.push_back("direct light: next-event estimation, weighted against gather rays");
    plan.globalMap = !traits.flat;
    plan.causticMap = traits.specular && !traits.flat;
    plan.tracePhotons = plan.globalMap || plan.causticMap;
    if (plan.globalMap) {
        plan.globalPhotons = settings.photons > 0 ? settings.photons : kAutoGlobalPhotons;
        plan.sitePhotons = std::max<std::uint64_t>(1, plan.globalPhotons / kPhotonsPerSite);
        plan.reasons.push_back(fmt::format(
            "global map: {} photons a pass, its irradiance kept where {} others land, for {} "
            "final-gather ray{} a sample",
            plan.globalPhotons, plan.sitePhotons, settings.gatherRays,
            settings.gatherRays > 1 ? "s" : ""));
    } else {
        plan.reasons.push_back("no global map: all surfaces lie in one plane");
    }
    if (plan.causticMap) {
        plan.causticPhotons = settings.photons > 0 ? settings.photons : kAutoCausticPhotons;
        plan.reasons.push_back(fmt::format(
            "caustic map: {} photons a pass, since the scene has surfaces that are not diffuse",
            plan.causticPhotons));
    } else {
        plan.reasons.push_back("no caustic map: every surface is diffuse");
    }
    plan.mapBytes =
        ((plan.globalPhotons + plan.sitePhotons) * kExpectedArrivals + plan.causticPhotons) *
        PhotonMap::kBytesPerPhoton;
    return plan;
}

std::uint64_t Plan::globalPilotPhotons() const {
    return globalPhotons / PilotRadius::kPilotShare + 1;
}

std::uint64_t Plan::causticPilotPhotons() const {
    return causticPhotons / PilotRadius::kPilotShare + 1;
}

std::string Plan::explain() const {
    std::string text;
    for (const std::string& reason : reasons) text += reason + "\n";
    if (tracePhotons)
        text += fmt::format("maps: at most about {:.1f} MB at a time\n",
                            static_cast<double>(mapBytes) / 1e6);
    return text;
}

}  // namespace pm
