// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/photon_pass.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "integrator/transport/frame_renderer.h"
#include "integrator/values/stopwatch.h"

namespace pm {

namespace {

// Radius of a pass over the first one's: r^2 shrinks by (i + a)/(i + 1) from pass i to the next, so
// that bias and variance both go to 0 over the passes.
// Source: Knaus & Zwicker 2011, eq. 20, alpha = 2/3.
float radiusFactor(std::uint32_t pass) {
    double squared = 1.0;
    for (std::uint32_t i = 0; i < pass; ++i) squared *= (i + 2.0 / 3.0) / (i + 1.0);
    return static_cast<float>(std::sqrt(squared));
}

}  // namespace

PhotonPass::PhotonPass(const Scene& scene, const LightSampler& lights, const Plan& plan,
                       const RenderSettings& settings)
    : m_scene(scene), m_lights(lights), m_plan(plan), m_settings(settings) {}

void PhotonPass::begin(std::uint32_t pass, const std::atomic<bool>& cancelled,
                       const std::function<void(double)>& progress) {
    m_sites.reset();
    m_globalMap.reset();
    m_causticMap.reset();
    if (!m_plan.tracePhotons) return;
    Control control{cancelled, progress};
    if (!m_haveRadii) findRadii(control);
    control.photonsBefore = 0;
    buildMaps(pass, control);
}

std::vector<Photon> PhotonPass::trace(PhotonKind kind, std::uint64_t count, std::uint32_t pass,
                                      Control& control) {
    const Stopwatch watch;
    const auto part = [&](double fraction) {
        if (control.progress)
            control.progress(std::min(1.0, (static_cast<double>(control.photonsBefore) +
                                            fraction * static_cast<double>(count)) /
                                               static_cast<double>(m_plan.photonsPerPass())));
    };
    PhotonTraceResult result = tracePhotons(m_scene, m_lights, {kind, count, m_settings.seed, pass},
                                            control.cancelled, part);
    control.photonsBefore += count;
    this->count(kind, result.balance);
    const std::lock_guard lock(m_mutex);
    m_photonSeconds += watch.seconds();
    return std::move(result.photons);
}

void PhotonPass::findRadii(Control& control) {
    // Where a pilot finds next to nothing, estimates reach a hundredth of the scene.
    const auto fallback = static_cast<float>(0.01 * m_scene.radius());
    if (m_plan.globalMap)
        m_globalRadius =
            PilotRadius(trace(PhotonKind::kGlobalPilot, m_plan.globalPilotPhotons(), 0, control),
                        m_settings.estimatePhotons, fallback)
                .typical();
    if (m_plan.causticMap)
        m_causticRadius = std::make_unique<CausticRadius>(
            trace(PhotonKind::kCausticPilot, m_plan.causticPilotPhotons(), 0, control),
            m_settings.estimatePhotons, fallback);
    m_haveRadii = true;
}

void PhotonPass::buildMaps(std::uint32_t pass, Control& control) {
    const float factor = radiusFactor(pass);
    double seconds = 0;
    if (m_plan.globalMap) {
        std::vector<Photon> photons =
            trace(PhotonKind::kGlobal, m_plan.globalPhotons, pass, control);
        std::vector<Photon> places = trace(PhotonKind::kSites, m_plan.sitePhotons, pass, control);
        const Stopwatch watch;
        m_globalMap = std::make_unique<PhotonMap>(std::move(photons));
        m_sites = std::make_unique<IrradianceSites>(m_scene, *m_globalMap, std::move(places),
                                                    m_globalRadius * factor);
        seconds += watch.seconds();
    }
    if (m_plan.causticMap) {
        std::vector<Photon> photons =
            trace(PhotonKind::kCaustic, m_plan.causticPhotons, pass, control);
        const Stopwatch watch;
        m_causticMap = std::make_unique<CausticMap>(std::move(photons), *m_causticRadius, factor);
        seconds += watch.seconds();
    }
    const std::uint64_t bytes =
        (m_globalMap ? m_globalMap->memoryBytes() + m_sites->memoryBytes() : 0) +
        (m_causticMap ? m_causticMap->memoryBytes() + m_causticRadius->memoryBytes() : 0);
    const std::lock_guard lock(m_mutex);
    m_mapSeconds += seconds;
    m_peakMapBytes = std::max(m_peakMapBytes, bytes);
}

void PhotonPass::count(PhotonKind kind, const PhotonBalance& balance) {
    const std::lock_guard lock(m_mutex);
    m_allKinds += balance;
    if (kind == PhotonKind::kGlobal) m_global += balance;
    if (kind == PhotonKind::kCaustic) m_storedCaustic += balance.stored;
    // Notices come once a render, from its pilots, not once a pass.
    if (balance.stored == 0 && kind == PhotonKind::kGlobalPilot)
        m_notices.push_back({NoticeCode::kNoPhotons,
                             "0 photons reached a diffuse surface, so there is no indirect light"});
    if (balance.stored == 0 && kind == PhotonKind::kCausticPilot)
        m_notices.push_back(
            {NoticeCode::kNoCausticPhotons,
             "0 photons reached a diffuse surface by way of another, so there is no "
             "caustic light"});
    if (balance.lost > 0 && (kind == PhotonKind::kGlobalPilot || kind == PhotonKind::kCausticPilot))
        m_notices.push_back({NoticeCode::kLostPhotons,
                             std::to_string(balance.lost) + " of " +
                                 std::to_string(balance.emitted) +
                                 " pilot photons were lost: caught between lossless surfaces or "
                                 "spoiled by rounding"});
}

void PhotonPass::addTo(RenderCounters& counters) const {
    const std::lock_guard lock(m_mutex);
    counters.rays += m_allKinds.rays;
    counters.photonsEmitted += m_allKinds.emitted;
    counters.photonsLost += m_allKinds.lost;
    counters.fluxEmitted += m_global.fluxEmitted;
    counters.fluxAbsorbed += m_global.fluxAbsorbed;
    counters.fluxEscaped += m_global.fluxEscaped;
    counters.fluxLost += m_global.fluxLost;
    counters.photonsStoredGlobal += m_global.stored;
    counters.photonsStoredCaustic += m_storedCaustic;
    counters.photonSeconds += m_photonSeconds;
    counters.mapSeconds += m_mapSeconds;
    counters.peakMapBytes = std::max(counters.peakMapBytes, m_peakMapBytes);
}

std::vector<Notice> PhotonPass::takeNotices() {
    const std::lock_guard lock(m_mutex);
    return std::exchange(m_notices, {});
}

}  // namespace pm
