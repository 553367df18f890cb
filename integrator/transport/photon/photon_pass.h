// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/photons/emission/aimed_emission.h"
#include "integrator/photons/emission/focus.h"
#include "integrator/photons/estimate/caustic_map.h"
#include "integrator/photons/estimate/irradiance_sites.h"
#include "integrator/photons/estimate/received_map.h"
#include "integrator/photons/map/photon_map.h"
#include "integrator/photons/map/photon_pages.h"
#include "integrator/photons/trace/photon_store.h"
#include "integrator/photons/trace/photon_tracer.h"
#include "integrator/scene/camera.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/frame/map_paging.h"
#include "integrator/transport/frame/render_settings.h"
#include "integrator/transport/frame/transport_plan.h"
#include "integrator/transport/photon/photon_integrator.h"
#include "integrator/transport/photon/traced_photons.h"
#include "integrator/values/notice.h"

namespace pm {

struct RenderCounters;

// The photons of one pass after another: traces what the plan wants and builds the maps that the
// pixels of the pass read. The radii of the estimates are found once, by pilots, and shrink from
// pass to pass; so any pass can be begun first.
class PhotonPass {
  public:
    // All arguments must outlive this.
    PhotonPass(const Scene& scene, const Camera& camera, const LightSampler& lights,
               const Plan& plan, const RenderSettings& settings);

    // As FrameRenderer::readPhotons and tracePass.
    void readFrom(const PhotonSource& source) { m_source = &source; }
    void pageMaps(const MapPaging& paging) { m_paging = paging; }
    void traceInto(PhotonSink& sink, std::uint32_t pass, const std::atomic<bool>& cancelled,
                   const std::function<void(double)>& progress);

    // As FrameRenderer::beginPass and addPass.
    void begin(std::uint32_t pass, const std::atomic<bool>& cancelled,
               const std::function<void(double)>& progress);
    void add(std::uint32_t pass, const std::atomic<bool>& cancelled,
             const std::function<void(double)>& progress);

    // Of a pass that was begun or added, the one that came last where none is named; none for
    // another. Valid until the next begin.
    PhotonMaps maps(std::uint32_t pass) const;
    PhotonMaps maps() const { return m_held.empty() ? PhotonMaps{} : m_held.back().view(); }

    // As FrameRenderer::forget.
    void forget(const Rect& region, const Rect& all) const;

    // Threads: any time.
    void addTo(RenderCounters& counters) const;
    std::vector<Notice> takeNotices();

  private:
    // What tracing reports to and is stopped by.
    struct Control {
        const std::atomic<bool>& cancelled;
        const std::function<void(double)>& progress;
        std::uint64_t photonsBefore = 0;
    };
    // The maps of one pass; null where the plan has none.
    struct PassMaps {
        std::uint32_t pass = 0;
        std::unique_ptr<PhotonMap> global;
        std::unique_ptr<IrradianceSites> sites;  // refers to global
        std::unique_ptr<PhotonMap> refocusedPhotons;
        std::unique_ptr<SurfaceEstimate> refocused;  // refers to refocusedPhotons
        std::unique_ptr<CausticMap> caustic;         // refers to m_causticRadius and m_patches
        std::unique_ptr<VirtualLamps> lamps;         // refers to caustic
        std::unique_ptr<ReceivedMap> received;       // refers to m_receivedRadius
        std::unique_ptr<GatherPoints> points;        // refers to sites, refocused and lamps

        PhotonMaps view() const {
            return {sites.get(),   points.get(), refocused.get(),
                    caustic.get(), lamps.get(),  received.get()};
        }
        std::uint64_t memoryBytes() const;
    };
    // Photons of one kind, traced, or read where there is a source of them.
    // rounds: take the photons; what is returned has none.
    PhotonTraceResult trace(PhotonKind kind, std::uint64_t count, std::uint32_t pass,
                            Control& control, const TraceRounds& rounds);
    // All at once.
    PhotonTraceResult trace(PhotonKind kind, std::uint64_t count, std::uint32_t pass,
                            Control& control);
    struct ForMaps {
        TracedPhotons photons, descended;
        std::vector<ReceivedPhoton> received;
        Focus focus{};
    };
    ForMaps traceForMaps(PhotonKind kind, std::uint64_t count, std::uint32_t pass,
                         Control& control);
    PhotonTraceResult tracePilotOfCaustics(PhotonTraceRequest request, const Control& control,
                                           const std::function<void(double)>& progress,
                                           const TraceRounds& rounds) const;
    TracedPhotons buildCaustics(PassMaps& maps, Control& control);
    // At which gather rays read caustics.
    float radiusOfGathered() const;
    const SurfacePatches* patchesOfSites(float radius) const;
    bool fillsSites(const PhotonMap& map) const;
    void buildIndirect(PassMaps& maps, TracedPhotons descended, Control& control);
    void findFocus(const CancelCheck& check);
    void aim(Control& control);
    TracedPhotons findCausticRadii(float fallback, Control& control);
    void chooseGatherRays(const PhotonMap& pilot, const CancelCheck& check);
    void findRadii(Control& control);
    void findGlobalRadius(TracedPhotons pilot, float fallback, const CancelCheck& check);
    void buildMaps(std::uint32_t pass, Control& control);
    void count(PhotonKind kind, const PhotonBalance& balance);

    void dropMaps();
    void noteBuilding(const PassMaps& maps, std::size_t photons);
    std::uint64_t heldMapBytes() const;  // m_mutex held, as for the next
    std::uint64_t peakMapBytes() const;

    const Scene& m_scene;
    const Camera& m_camera;
    const LightSampler& m_lights;
    const Plan& m_plan;
    const RenderSettings& m_settings;
    const PhotonSource* m_source = nullptr;  // null: photons are traced
    MapPaging m_paging;
    bool m_pilotsAreKept = false;  // by the sink
    // Of the first pass, scene units.
    bool m_haveRadii = false;
    float m_globalRadius = 0.0f;               // in focus
    Focus m_focus;                             // of the global photons
    std::uint32_t m_raysOfPoint = 0;           // gather rays; 0 until the radii are known
    std::unique_ptr<GatherGuide> m_guide;      // of gather rays; null: by the cosine alone
    std::unique_ptr<AimedEmission> m_focused;  // of global photons; null: unaimed
    std::unique_ptr<AimedEmission> m_aim;      // of caustic photons
    std::unique_ptr<PilotRadius> m_causticRadius, m_refocusedRadius, m_receivedRadius;
    std::unique_ptr<SurfacePatches> m_patches;  // filled as the passes go on

    mutable std::mutex m_mutex;    // of what follows
    std::vector<PassMaps> m_held;  // of the pass begun last and of those added since
    PhotonBalance m_allKinds, m_global, m_caustic;
    std::uint64_t m_peakMapBytes = 0;
    std::uint64_t m_gatherRays = 0;  // of the passes whose maps were dropped
    bool m_noGlobalPhotons = false;  // of the pilot
    double m_photonSeconds = 0, m_mapSeconds = 0;
    std::vector<Notice> m_notices;
};

}  // namespace pm
