// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/photon/photon_pass.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <span>
#include <utility>

#include "integrator/transport/frame/gather_count.h"
#include "integrator/transport/frame/pass_radius.h"
#include "integrator/transport/frame/render_counters.h"
#include "integrator/transport/photon/photon_lists.h"
#include "integrator/values/stopwatch.h"

namespace pm {

PhotonPass::PhotonPass(const Scene& scene, const Camera& camera, const LightSampler& lights,
                       const Plan& plan, const RenderSettings& settings)
    : m_scene(scene), m_camera(camera), m_lights(lights), m_plan(plan), m_settings(settings) {}

void PhotonPass::begin(std::uint32_t pass, const std::atomic<bool>& cancelled,
                       const std::function<void(double)>& progress) {
    dropMaps();
    add(pass, cancelled, progress);
}

void PhotonPass::add(std::uint32_t pass, const std::atomic<bool>& cancelled,
                     const std::function<void(double)>& progress) {
    if (!m_plan.tracePhotons) return;
    Control control{cancelled, progress};
    if (!m_haveRadii) findRadii(control);
    control.photonsBefore = 0;
    buildMaps(pass, control);
}

void PhotonPass::traceInto(PhotonSink& sink, std::uint32_t pass, const std::atomic<bool>& cancelled,
                           const std::function<void(double)>& progress) {
    Control control{cancelled, progress};
    const auto keep = [&](PhotonKind kind, std::uint64_t count, std::uint32_t ofPass) {
        sink.write(kind, ofPass, trace(kind, count, ofPass, control), cancelled);
    };
    if (!m_pilotsAreKept) {
        if (m_plan.globalMap) {
            findFocus(CancelCheck(cancelled));
            keep(PhotonKind::kGlobalPilot, m_plan.globalPilotPhotons(), 0);
        }
        if (m_plan.causticMap) {
            aim(control);
            keep(PhotonKind::kCausticPilot, m_plan.causticPilotPhotons(), 0);
        }
        m_pilotsAreKept = true;
        control.photonsBefore = 0;
    }
    if (m_plan.causticMap) keep(PhotonKind::kCaustic, m_plan.causticPhotons, pass);
    if (m_plan.globalMap) keep(PhotonKind::kGlobal, m_plan.globalPhotons, pass);
}

PhotonMaps PhotonPass::maps(std::uint32_t pass) const {
    for (const PassMaps& held : m_held)
        if (held.pass == pass) return held.view();
    return {};
}

std::uint64_t PhotonPass::PassMaps::memoryBytes() const {
    const auto bytesOf = [](const auto& part) { return part ? part->memoryBytes() : 0; };
    return bytesOf(global) + bytesOf(sites) + bytesOf(points) + bytesOf(refocusedPhotons) +
           bytesOf(caustic) + bytesOf(lamps) + bytesOf(received);
}

// A map of so many photons was just built, as the last one of these.
void PhotonPass::noteBuilding(const PassMaps& maps, std::size_t photons) {
    const std::lock_guard lock(m_mutex);
    const std::uint64_t building =
        m_paging.pages ? m_paging.pages->mostBuildBytes()
                       : photons * (PhotonMap::kBytesPerPhoton - PhotonMap::kHeldBytesPerPhoton);
    m_peakMapBytes = std::max(m_peakMapBytes, heldMapBytes() + maps.memoryBytes() + building);
}

// Patches and gather points grow as a pass is rendered.
std::uint64_t PhotonPass::heldMapBytes() const {
    std::uint64_t held = m_patches->memoryBytes();
    for (const auto* const radius :
         {m_causticRadius.get(), m_refocusedRadius.get(), m_receivedRadius.get()})
        if (radius) held += radius->memoryBytes();
    for (const PassMaps& maps : m_held) held += maps.memoryBytes();
    if (m_paging.pages) held += m_paging.pages->counts().bytesHeld;
    return held;
}

std::uint64_t PhotonPass::peakMapBytes() const {
    return m_held.empty() ? m_peakMapBytes : std::max(m_peakMapBytes, heldMapBytes());
}

void PhotonPass::forget(const Rect& region, const Rect& all) const {
    for (const PassMaps& held : m_held)
        if (held.points) held.points->forget(region, all);
}

void PhotonPass::dropMaps() {
    const std::lock_guard lock(m_mutex);
    m_peakMapBytes = peakMapBytes();
    for (const PassMaps& held : m_held)
        if (held.points) m_gatherRays += held.points->raysTraced();
    m_held.clear();
}

PhotonTraceResult PhotonPass::trace(PhotonKind kind, std::uint64_t count, std::uint32_t pass,
                                    Control& control, const TraceRounds& rounds) {
    const Stopwatch watch;
    const auto part = [&](double fraction) {
        if (control.progress)
            control.progress(std::min(1.0, (static_cast<double>(control.photonsBefore) +
                                            fraction * static_cast<double>(count)) /
                                               static_cast<double>(m_plan.photonsPerPass())));
    };
    PhotonTraceRequest request{kind, count, m_settings.seed, pass};
    request.aim = isCaustic(kind) ? m_aim.get() : m_focused.get();
    if (isCaustic(kind)) request.descent = m_plan.descent;
    request.received = isCaustic(kind) && m_plan.receivedMap;
    request.withoutCaustics = m_plan.descent > 0.0f;
    request.oneInChains = m_plan.oneInChains;
    PhotonTraceResult result =
        m_source ? m_source->readInRounds(kind, pass, control.cancelled, rounds)
        : kind == PhotonKind::kCausticPilot
            ? tracePilotOfCaustics(request, control, part, rounds)
            : traceInRounds(m_scene, m_lights, request, control.cancelled, part, rounds);
    if (m_source) part(1.0);
    control.photonsBefore += count;
    this->count(kind, result.balance);
    const std::lock_guard lock(m_mutex);
    m_photonSeconds += watch.seconds();
    return result;
}

PhotonTraceResult PhotonPass::trace(PhotonKind kind, std::uint64_t count, std::uint32_t pass,
                                    Control& control) {
    PhotonTraceResult all;
    const PhotonTraceResult rest =
        trace(kind, count, pass, control,
              {TraceRounds::kAll, [&](PhotonTraceResult part) { append(all, std::move(part)); }});
    all.balance = rest.balance;
    all.focus = rest.focus;
    return all;
}

// In files where maps are in pages.
PhotonPass::ForMaps PhotonPass::traceForMaps(PhotonKind kind, std::uint64_t count,
                                             std::uint32_t pass, Control& control) {
    ForMaps traced{TracedPhotons(m_paging.pages), TracedPhotons(m_paging.pages), {}};
    TraceRounds rounds;
    if (m_paging.pages) rounds.bytes = m_paging.pages->buildBudget();
    rounds.take = [&](PhotonTraceResult part) {
        traced.photons.append(std::move(part.photons));
        traced.descended.append(std::move(part.descended));
        traced.received.insert(traced.received.end(), part.received.begin(), part.received.end());
    };
    traced.focus = trace(kind, count, pass, control, rounds).focus;
    return traced;
}

// Returns the descended photons, which gather rays read beside the global ones.
TracedPhotons PhotonPass::buildCaustics(PassMaps& maps, Control& control) {
    ForMaps traced = traceForMaps(PhotonKind::kCaustic, m_plan.causticPhotons, maps.pass, control);
    const Stopwatch watch;
    const CancelCheck check(control.cancelled);
    const float factor = radiusFactor(maps.pass);
    const std::size_t landed = traced.photons.size();
    maps.caustic = std::make_unique<CausticMap>(traced.photons.intoMap(check), *m_causticRadius,
                                                factor, m_patches.get());
    noteBuilding(maps, landed);
    if (m_plan.receivedMap) {
        maps.received = std::make_unique<ReceivedMap>(m_scene, std::move(traced.received),
                                                      *m_receivedRadius, factor, check);
        noteBuilding(maps, maps.received->size());
    }
    if (m_plan.descent > 0.0f) {
        const float radius = radiusOfGathered();
        maps.lamps = std::make_unique<VirtualLamps>(
            m_scene, maps.caustic->photons(), radius * factor, patchesOfSites(radius), factor,
            combineBits(m_settings.seed, maps.pass), check, m_paging.roomForSites);
        if (fillsSites(maps.caustic->photons())) maps.lamps->fill(check);
        if (m_refocusedRadius) {
            maps.refocusedPhotons = std::make_unique<PhotonMap>(
                traced.descended.refocused().intoMap(check, m_scene.coreRadiusIfAny()));
            maps.refocused = std::make_unique<SurfaceEstimate>(
                m_scene, *maps.refocusedPhotons, m_refocusedRadius->typical() * factor);
            noteBuilding(maps, maps.refocusedPhotons->size());
        }
    }
    const std::lock_guard lock(m_mutex);
    m_mapSeconds += watch.seconds();
    return std::move(traced.descended);
}

// Patches pay where one serves many sites and most surfaces are flat across an estimate's disc;
// among small triangles rays of each site's own cost less.
const SurfacePatches* PhotonPass::patchesOfSites(float radius) const {
    const double disc =
        std::numbers::pi * static_cast<double>(radius) * static_cast<double>(radius);
    return m_scene.meanTriangleArea() > disc ? m_patches.get() : nullptr;
}

// Gather rays end in no order, and so ask for pages of a map in none: where many will, its sites
// are filled before, in the map's order. That takes some 3 us a photon; a ray else reads three or
// four pages, of some 100 us each where the disk's own cache is short, too. See
// docs/lab/order_caches.md.
bool PhotonPass::fillsSites(const PhotonMap& map) const {
    if (!map.isPaged() || m_paging.pages->budget() >= m_paging.pages->wholeBytes()) return false;
    constexpr double kPhotonsOfRay = 128.0;
    const auto pixels = static_cast<double>(m_settings.window.area());
    const double rays = gatherPointsOf(pixels, m_plan.gatherSpacing) * m_raysOfPoint;
    return rays * static_cast<double>(m_paging.shareOfWindow) * kPhotonsOfRay >=
           static_cast<double>(map.size());
}

void PhotonPass::buildIndirect(PassMaps& maps, TracedPhotons descended, Control& control) {
    ForMaps traced = traceForMaps(PhotonKind::kGlobal, m_plan.globalPhotons, maps.pass, control);
    const Stopwatch watch;
    const float factor = radiusFactor(maps.pass);
    traced.photons.append(std::move(descended));
    maps.global = std::make_unique<PhotonMap>(
        traced.photons.intoMap(CancelCheck(control.cancelled), m_scene.coreRadiusIfAny()));
    noteBuilding(maps, maps.global->size());
    maps.sites = std::make_unique<IrradianceSites>(
        m_scene, *maps.global, m_globalRadius * factor, patchesOfSites(m_globalRadius), factor,
        m_focus, m_paging.roomForSites, combineBits(m_settings.seed, maps.pass));
    if (fillsSites(*maps.global)) maps.sites->fill(CancelCheck(control.cancelled));
    const GatherPoints::Request request{.width = m_settings.width,
                                        .height = m_settings.height,
                                        .spacing = m_plan.gatherSpacing,
                                        .rays = m_raysOfPoint,
                                        .radiusFactor = factor,
                                        .seed = m_settings.seed,
                                        .pass = maps.pass,
                                        .caustics = maps.lamps.get(),
                                        .refocused = maps.refocused.get(),
                                        .refocusedRadius = m_refocusedRadius.get(),
                                        .guide = m_guide.get(),
                                        .lights = &m_lights};
    maps.points = std::make_unique<GatherPoints>(m_scene, m_camera, *maps.sites, request);
    const std::lock_guard lock(m_mutex);
    m_mapSeconds += watch.seconds();
}

void PhotonPass::buildMaps(std::uint32_t pass, Control& control) {
    PassMaps maps;
    maps.pass = pass;
    {
        const std::lock_guard lock(m_mutex);
        m_peakMapBytes = peakMapBytes();
        m_patches->makeRoom();
    }
    TracedPhotons descended(m_paging.pages);
    if (m_plan.causticMap) descended = buildCaustics(maps, control);
    if (m_plan.globalMap) buildIndirect(maps, std::move(descended), control);
    const std::lock_guard lock(m_mutex);
    m_held.push_back(std::move(maps));
}

void PhotonPass::count(PhotonKind kind, const PhotonBalance& balance) {
    const std::lock_guard lock(m_mutex);
    m_allKinds += balance;
    if (kind == PhotonKind::kGlobal) m_global += balance;
    if (kind == PhotonKind::kCaustic) m_caustic += balance;
    // Notices come once a render, from its pilots, not once a pass.
    if (kind == PhotonKind::kGlobalPilot) m_noGlobalPhotons = balance.stored == 0;
    const bool noCaustics = kind == PhotonKind::kCausticPilot && balance.stored == 0;
    // Behind glass all light is descended from caustics.
    const bool noOthers = m_plan.descent > 0.0f ? noCaustics : kind == PhotonKind::kGlobalPilot;
    if (m_noGlobalPhotons && noOthers)
        m_notices.push_back({NoticeCode::kNoPhotons,
                             "0 photons reached a diffuse surface, so there is no indirect light"});
    if (noCaustics)
        m_notices.push_back(
            {NoticeCode::kNoCausticPhotons,
             "0 photons reached a diffuse surface by way of another, so there is no "
             "caustic light"});
    if (balance.lost > 0 && (kind == PhotonKind::kGlobalPilot || kind == PhotonKind::kCausticPilot))
        m_notices.push_back({NoticeCode::kLostPhotons,
                             fmt::format("{} of {} pilot photons were lost, with {:.2g} % of the "
                                         "flux: caught between lossless surfaces or spoiled by "
                                         "rounding",
                                         balance.lost, balance.emitted,
                                         100 * balance.fluxLost / balance.fluxEmitted)});
}

void PhotonPass::addTo(RenderCounters& counters) const {
    const std::lock_guard lock(m_mutex);
    counters.rays += m_allKinds.rays + m_gatherRays;
    for (const PassMaps& held : m_held)
        if (held.points) counters.rays += held.points->raysTraced();
    counters.photonsEmitted += m_allKinds.emitted;
    counters.photonsLost += m_allKinds.lost;
    counters.gatherRaysOfPoint = m_raysOfPoint;
    counters.gatherRaysGuided = m_guide != nullptr;
    counters.photonsInFocus = !m_focus.isEverywhere();
    counters.fluxEmitted += m_global.fluxEmitted;
    counters.fluxAbsorbed += m_global.fluxAbsorbed;
    counters.fluxEscaped += m_global.fluxEscaped;
    counters.fluxLost += m_global.fluxLost;
    counters.causticFluxEmitted += m_caustic.fluxEmitted;
    counters.causticFluxLost += m_caustic.fluxLost;
    counters.photonsStoredGlobal += m_global.stored;
    counters.photonsStoredCaustic += m_caustic.stored;
    counters.photonSeconds += m_photonSeconds;
    counters.mapSeconds += m_mapSeconds;
    counters.peakMapBytes = std::max(counters.peakMapBytes, peakMapBytes());
}

std::vector<Notice> PhotonPass::takeNotices() {
    const std::lock_guard lock(m_mutex);
    return std::exchange(m_notices, {});
}

}  // namespace pm
