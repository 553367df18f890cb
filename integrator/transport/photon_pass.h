// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "integrator/photons/aimed_emission.h"
#include "integrator/photons/caustic_map.h"
#include "integrator/photons/irradiance_sites.h"
#include "integrator/photons/photon_map.h"
#include "integrator/photons/photon_tracer.h"
#include "integrator/scene/camera.h"
#include "integrator/scene/light_sampler.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/photon_integrator.h"
#include "integrator/transport/plan.h"
#include "integrator/transport/render_settings.h"
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

    // As FrameRenderer::beginPass.
    void begin(std::uint32_t pass, const std::atomic<bool>& cancelled,
               const std::function<void(double)>& progress);

    // Of the pass that was begun; valid until the next begin.
    PhotonMaps maps() const {
        return {m_sites.get(), m_points.get(), m_descended.get(), m_causticMap.get()};
    }

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
    PhotonTraceResult trace(PhotonKind kind, std::uint64_t count, std::uint32_t pass,
                            Control& control);
    void buildCaustics(std::uint32_t pass, Control& control);
    void buildIndirect(std::uint32_t pass, Control& control);
    void aim(Control& control);
    void findRadii(Control& control);
    void buildMaps(std::uint32_t pass, Control& control);
    void count(PhotonKind kind, const PhotonBalance& balance);

    void dropMaps();

    const Scene& m_scene;
    const Camera& m_camera;
    const LightSampler& m_lights;
    const Plan& m_plan;
    const RenderSettings& m_settings;
    // Of the first pass, scene units.
    bool m_haveRadii = false;
    float m_globalRadius = 0.0f, m_descendedRadius = 0.0f;
    std::unique_ptr<AimedEmission> m_aim;  // of caustic photons
    std::unique_ptr<CausticRadius> m_causticRadius;
    std::unique_ptr<SurfacePatches> m_patches;  // of caustic estimates; filled as the passes go on
    // Of this pass.
    std::unique_ptr<PhotonMap> m_globalMap;
    std::unique_ptr<IrradianceSites> m_sites;  // refers to m_globalMap
    std::unique_ptr<PhotonMap> m_descendedMap;
    std::unique_ptr<SurfaceEstimate> m_descended;  // refers to m_descendedMap
    std::unique_ptr<GatherPoints> m_points;        // refers to m_sites and m_descended
    std::unique_ptr<CausticMap> m_causticMap;      // refers to m_causticRadius and m_patches

    mutable std::mutex m_mutex;  // of what follows
    PhotonBalance m_allKinds, m_global;
    std::uint64_t m_storedCaustic = 0, m_peakMapBytes = 0;
    std::uint64_t m_gatherRays = 0;  // of the passes before this one
    double m_photonSeconds = 0, m_mapSeconds = 0;
    std::vector<Notice> m_notices;
};

}  // namespace pm
