// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What a PhotonPass finds once a render, by pilots: where photons are aimed, the radii of the
// estimates, the number of gather rays and whether they are guided.
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "integrator/transport/photon/photon_lists.h"
#include "integrator/transport/photon/photon_pass.h"
#include "integrator/transport/survey/gather_focus.h"
#include "integrator/transport/survey/gather_pilot.h"
#include "integrator/transport/survey/pilot_passes.h"
#include "integrator/transport/survey/sky_openings.h"

namespace pm {

namespace {

// Gather rays go by a guide where that leaves less than this of their variance.
constexpr double kGuidePays = 0.5;
// Radius at which gather rays read caustics, over the typical one of those that are seen: rays blur
// them anyway.
constexpr float kRadiusOfGathered = 2.0f;
// Refocused photons so thin that their estimates would be wider than this, over the typical radius
// of caustics, blur more than gather rays do, which read caustics by way of all lobes then.
constexpr float kSparseRefocused = 3.5f;
// Caustics' radii, which rise slowly beside bright light, are to hold so many times K photons.
constexpr double kSoughtInCaustics = 1.6;

// Where a pilot finds next to nothing, estimates reach a hundredth of what is in focus.
float fallbackIn(const Focus& focus) {
    return 0.01f / std::sqrt(focus.inverseRadiusSquared);
}

}  // namespace

float PhotonPass::radiusOfGathered() const {
    return kRadiusOfGathered * m_causticRadius->typical();
}

void PhotonPass::findFocus(const CancelCheck& check) {
    const Focus focus = findGatherFocus(m_scene, m_camera, m_settings, check);
    if (!focus.isEverywhere()) {
        m_focused = std::make_unique<AimedEmission>(
            AimedEmission::atFocus(m_scene, m_lights, focus, check));
        return;
    }
    SkyOpenings openings = findSkyOpenings(m_scene, m_camera, m_settings, check);
    if (!openings.balls.empty())
        m_focused = std::make_unique<AimedEmission>(AimedEmission::atOpenings(
            m_scene, m_lights, std::move(openings.balls), openings.seenShare, check));
}

// What light is sent to which casters of caustics: a geometric guess, and a pilot that finds what
// is hidden.
void PhotonPass::aim(Control& control) {
    const CancelCheck check(control.cancelled);
    m_aim = std::make_unique<AimedEmission>(
        m_scene, m_lights, findSeenFocus(m_scene, m_camera, m_settings, check), check);
    if (m_aim->empty()) return;
    PhotonTraceRequest request{PhotonKind::kCausticPilot,
                               m_plan.aimPilotPhotons(),
                               m_settings.seed,
                               kPilotOfAiming,
                               m_aim.get(),
                               true};
    request.received = m_plan.receivedMap;
    const PhotonTraceResult landed =
        tracePhotons(m_scene, m_lights, request, control.cancelled, {});
    m_aim->refine(landed.records);
}

void PhotonPass::chooseGatherRays(const PhotonMap& pilot, const CancelCheck& check) {
    m_raysOfPoint = m_plan.gatherRays;
    if (!m_plan.gatherRaysByPilot) return;
    const IrradianceSites sites(m_scene, pilot, m_globalRadius, nullptr, 1.0f, m_focus, 1.0f,
                                m_settings.seed);
    std::optional<VirtualLamps> lamps;
    if (m_plan.descent > 0.0f)
        lamps.emplace(m_scene, m_causticRadius->photons(), radiusOfGathered(), nullptr, 1.0f,
                      m_settings.seed, check);
    GatherEnds ends{sites, lamps ? &*lamps : nullptr, m_plan.gatherRays, &m_lights};
    ends.findsRefocused = !m_refocusedRadius;
    m_raysOfPoint = gatherRaysFor(
        gatherSpread(m_scene, m_camera, m_lights, ends, m_settings, m_plan.errorScale, check),
        m_plan.gatherRays);
    const bool always = m_settings.plan == PlanKind::kEverything;
    if (m_raysOfPoint <= m_plan.gatherRays && !always) return;
    auto guide = std::make_unique<GatherGuide>(pilot, m_globalRadius);
    const auto [byCosine, byGuide] = gatherRivals(m_scene, m_camera, m_lights, ends, *guide,
                                                  m_settings, m_plan.errorScale, check);
    if (byGuide < kGuidePays * byCosine || always) m_guide = std::move(guide);
}

// In two halves: what one shows of where light is uneven, the other can be asked about.
PhotonTraceResult PhotonPass::tracePilotOfCaustics(PhotonTraceRequest request,
                                                   const Control& control,
                                                   const std::function<void(double)>& progress,
                                                   const TraceRounds& rounds) const {
    request.count = (request.count + 1) / 2;
    const auto traceHalf = [&](bool isSecond) {
        const TraceRounds halved{rounds.bytes, [&](PhotonTraceResult part) {
                                     halve(part, isSecond);
                                     rounds.take(std::move(part));
                                 }};
        return traceInRounds(
            m_scene, m_lights, request, control.cancelled,
            [&](double fraction) { progress(0.5 * (fraction + (isSecond ? 1.0 : 0.0))); }, halved);
    };
    PhotonTraceResult both = traceHalf(false);
    request.pass = kPilotOfSecondHalf;
    both.balance = ofHalves(both.balance, traceHalf(true).balance);
    return both;
}

// Of caustics and, where there is enough of it, of refocused light. Returns the pilot's descended
// photons.
TracedPhotons PhotonPass::findCausticRadii(float fallback, Control& control) {
    if (!m_source) aim(control);
    const CancelCheck check(control.cancelled);
    ForMaps pilot = traceForMaps(PhotonKind::kCausticPilot, m_plan.causticPilotPhotons(),
                                 kPilotOfRadii, control);
    const auto sought = static_cast<std::uint32_t>(kSoughtInCaustics * m_settings.estimatePhotons);
    m_causticRadius =
        std::make_unique<PilotRadius>(pilot.photons.intoMap(check), sought, fallback, check);
    if (m_plan.receivedMap)
        m_receivedRadius =
            std::make_unique<PilotRadius>(photonsOf(pilot.received), sought, fallback, check);
    if (m_plan.descent > 0.0f) {
        m_refocusedRadius = std::make_unique<PilotRadius>(
            pilot.descended.refocused().intoMap(check), sought, fallback, check);
        if (m_refocusedRadius->typical() > kSparseRefocused * m_causticRadius->typical())
            m_refocusedRadius.reset();
    }
    return std::move(pilot.descended);
}

// Of what is in focus; gather rays read what is beyond, too.
void PhotonPass::findGlobalRadius(TracedPhotons pilot, float fallback, const CancelCheck& check) {
    if (m_focus.isEverywhere()) {
        const PhotonMap map = pilot.intoMap(check, m_scene.coreRadiusIfAny());
        m_globalRadius = PilotRadius::typicalOf(map, m_settings.estimatePhotons, fallback);
        chooseGatherRays(map, check);
        return;
    }
    TracedPhotons focused =
        pilot.those([&](const Photon& photon) { return m_focus.levelAt(photon.position) == 0; });
    m_globalRadius = PilotRadius::typicalOf(focused.intoMap(check), m_settings.estimatePhotons,
                                            fallbackIn(m_focus));
    chooseGatherRays(pilot.intoMap(check, m_scene.coreRadiusIfAny()), check);
}

void PhotonPass::findRadii(Control& control) {
    // Where a pilot finds next to nothing, estimates reach a hundredth of the scene.
    const auto fallback = static_cast<float>(0.01 * m_scene.coreRadius());
    const CancelCheck check(control.cancelled);
    TracedPhotons global(m_paging.pages);
    if (m_plan.globalMap) {
        if (!m_source) findFocus(check);
        ForMaps pilot =
            traceForMaps(PhotonKind::kGlobalPilot, m_plan.globalPilotPhotons(), 0, control);
        // Of photons that are read, that of the view which they were made for.
        m_focus = pilot.focus;
        global = std::move(pilot.photons);
    }
    if (m_plan.causticMap) global.append(findCausticRadii(fallback, control));
    if (m_plan.globalMap) findGlobalRadius(std::move(global), fallback, check);
    // By the sites' radius, so that they know nothing of caustics.
    const bool byCaustics = m_causticRadius && !m_plan.globalMap;
    m_patches = std::make_unique<SurfacePatches>(
        m_scene, byCaustics ? m_causticRadius->typical() : m_globalRadius);
    m_haveRadii = true;
}

}  // namespace pm
