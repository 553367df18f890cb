// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/survey/landing_pilot.h"

#include <algorithm>
#include <atomic>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/photons/trace/photon_tracer.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/frame/transport_plan.h"
#include "integrator/transport/survey/pilot_passes.h"

namespace pm {

namespace {

constexpr std::uint64_t kGlobalPhotons = 1024, kCausticPhotons = 4096;
// With fewer that meet casters next to nothing is known of them.
constexpr std::uint64_t kFewestAtCasters = 16;
// Of those that are aimed at casters, the share that meets one, about: some leave unaimed, and past
// what is no ball.
constexpr double kAimedMeet = 0.6;
// A pass's number that the other pilot of global photons doesn't have.
constexpr std::uint32_t kGlobalPass = 2;

PhotonTraceResult trace(const Scene& scene, const PhotonTraceRequest& request,
                        const std::atomic<bool>& cancelled) {
    return tracePhotons(scene, LightSampler::forPhotons(scene), request, cancelled, {});
}

PhotonTraceRequest globalRequest(const RenderSettings& settings) {
    return {PhotonKind::kGlobalPilot, kGlobalPhotons, settings.seed, kGlobalPass};
}

double ratio(std::uint64_t part, std::uint64_t whole) {
    return static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

LandingPilot LandingPilot::of(const Scene& scene, const RenderSettings& settings,
                              const std::atomic<bool>& cancelled) {
    PhotonTraceRequest request = globalRequest(settings);
    request.oneInChains = 1;
    const PhotonTraceResult traced = trace(scene, request, cancelled);
    if (!(traced.balance.fluxEmitted > 0)) return {};
    double landed = 0;
    for (const Photon& photon : traced.photons) landed += channelSum(photon.flux);
    return {landed / traced.balance.fluxEmitted,
            ratio(traced.balance.stored, traced.balance.emitted)};
}

void expectLandings(const Scene& scene, const RenderSettings& settings,
                    const std::atomic<bool>& cancelled, Plan& plan) {
    if (plan.globalMap) {
        PhotonTraceRequest request = globalRequest(settings);
        request.withoutCaustics = plan.descent > 0.0f;
        request.oneInChains = plan.oneInChains;
        const PhotonBalance balance = trace(scene, request, cancelled).balance;
        if (balance.emitted > 0) plan.landingsOfPhoton = ratio(balance.stored, balance.emitted);
    }
    if (!plan.causticMap) return;
    PhotonTraceRequest request{PhotonKind::kCausticPilot, kCausticPhotons, settings.seed,
                               kPilotOfLandings};
    request.descent = plan.descent;
    request.received = plan.receivedMap;
    request.oneInChains = plan.oneInChains;
    const PhotonTraceResult traced = trace(scene, request, cancelled);
    if (traced.metCaster < kFewestAtCasters) return;
    const auto refocused = static_cast<std::uint64_t>(std::ranges::count_if(
        traced.descended, [](const Photon& photon) { return photon.normal.isMarked(); }));
    plan.causticLandingsOfPhoton = kAimedMeet * ratio(traced.photons.size(), traced.metCaster);
    plan.receivedOfPhoton = kAimedMeet * ratio(traced.received.size(), traced.metCaster);
    plan.refocusedOfPhoton = kAimedMeet * ratio(refocused, traced.metCaster);
    plan.descendedOfPhoton = kAimedMeet * ratio(traced.descended.size(), traced.metCaster);
}

}  // namespace pm
