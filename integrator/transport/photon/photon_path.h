// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/transport/path/camera_step.h"
#include "integrator/transport/path/direct_light.h"
#include "integrator/transport/photon/photon_integrator.h"

namespace pm {

// A camera path on its way, or a branch of it.
struct PhotonBranch : CameraStep {
    using CameraStep::CameraStep;
    PathState state{};
    LastScatter last{};
    std::uint32_t lampSamples = 1;
    float way = 0.0f;  // that it has come, scene units
    // Of what the camera sample brings, this branch's part, were all that it meets as bright: what
    // is worth how much work.
    float share = 1.0f;
    std::uint32_t parts = 1;  // into how many paths the sample's has divided on the way here
};

// The camera paths of one sample.
class PhotonPath {
  public:
    using Step = PhotonBranch;
    static constexpr Transport kTransport = Transport::kRadiance;

    PhotonPath(const Scene& scene, const LightSampler& lights, const PhotonMaps& maps,
               std::uint32_t lampSamples, const PhotonIntegrator::View& view,
               NearestPhotons& scratch)
        : m_scene(scene),
          m_lights(lights),
          m_maps(maps),
          m_lampSamples(lampSamples),
          m_view(view),
          m_scratch(scratch) {}

    const SampleRadiance& result() const { return m_result; }

    static CacheUser user(const PhotonBranch& branch) { return branch.user(); }
    void setOut(const PhotonBranch&) { ++m_result.rays; }
    void meetNothing(const PhotonBranch& branch) {
        if (isOfMap(branch.state)) return;
        m_result.of(branch.state.classify()) +=
            branch.carried * weightedFarLight(m_scene, m_lights, branch.last);
    }
    Verdict meet(PhotonBranch& branch, const Surface& surface) {
        branch.way += length(surface.position - branch.ray.origin);
        const PathClass found = branch.state.classify();
        if (!isOfMap(branch.state) && (m_view.withSeenLamps || found != PathClass::kEmission))
            m_result.of(found) += branch.carried * weightedEmission(m_lights, surface, branch.last);
        return Verdict::kScatter;
    }
    bool scatter(PhotonBranch& branch, Surface& surface, Bsdf& bsdf,
                 Waiting<PhotonBranch>& waiting) {
        bsdf.followAll();
        recordFirstHit(surface, bsdf, m_result);
        if (bsdf.isBlackBody()) return false;
        // Where photons are looked up, and rays leave for lamps and light that was reflected.
        if (bsdf.has(Lobe::kDiffuse))
            surface.position =
                m_scene.pointUnderRay(surface.position, branch.ray, bsdf.facingGeometricNormal());
        const StillToFind still = addReflected(surface, bsdf, branch);
        if (bsdf.isDiffuseOnly()) {
            if (still.any()) followDiffuse(surface, bsdf, branch, still, 1.0f);
            return false;
        }
        return followLobes(surface, bsdf, still, branch, waiting);
    }

  private:
    // Which part of a diffuse reflection a ray along the lobe still has to find.
    struct StillToFind {
        DirectStrategy lamps = DirectStrategy::kBoth;
        bool indirect = false;
        std::uint32_t ownRays = 1;  // by how many rays along it
        float width = 0.0f;         // of the footprint that they start from, scene units

        bool any() const { return indirect || lamps == DirectStrategy::kBoth; }
    };

    bool followLobes(const Surface& surface, const Bsdf& bsdf, StillToFind still,
                     PhotonBranch& branch, Waiting<PhotonBranch>& waiting);
    bool goOn(PhotonBranch& branch, const Surface& surface, const Bsdf& bsdf, Lobe lobe,
              float survival, bool isPart);
    void addLampsAlong(PhotonBranch& branch);
    StillToFind addReflected(const Surface& surface, const Bsdf& bsdf, const PhotonBranch& branch);
    StillToFind readMaps(const Surface& surface, const Bsdf& bsdf, const PhotonBranch& branch);
    void addReceived(const Surface& surface, const Bsdf& bsdf, const PhotonBranch& branch);
    // Whether a map has the light that a path in this state finds at a lamp.
    bool isOfMap(const PathState& state) const { return m_maps.received && state.isCausticOnWide; }
    void addRefocused(const GatherPoints::Place& place, float clearance, float share,
                      const Rgb& reflected, const PhotonBranch& branch);
    void followDiffuse(const Surface& surface, const Bsdf& bsdf, const PhotonBranch& branch,
                       StillToFind still, float survival);
    // random: of the ray.
    void followBroad(const Surface& surface, const Bsdf& bsdf, const PhotonBranch& branch,
                     float survival, Sampler random);
    void gatherAlong(const Ray& ray, const LastScatter& last, StillToFind still, const Rgb& weight,
                     std::uint32_t rays, float cosine, const Sampler& sampler);
    void sampleCaustics(const Surface& surface, const Bsdf& bsdf, const PhotonBranch& branch,
                        std::uint32_t rays);

    std::uint32_t ownGatherRays(float share) const;
    // Of all that a surface reflects, a lobe's part.
    static float partOf(const Bsdf& bsdf, Lobe lobe);
    // Into how many paths one divides along a lobe, a power of two.
    static std::uint32_t partsAlong(const PhotonBranch& branch, const Bsdf& bsdf, Lobe lobe);
    // Of so many rays, a power of two, those that a part of a camera sample is worth; see
    // PhotonBranch::share.
    static std::uint32_t raysOfShare(std::uint32_t rays, float share);

    const Scene& m_scene;
    const LightSampler& m_lights;
    const PhotonMaps& m_maps;
    const std::uint32_t m_lampSamples;
    const PhotonIntegrator::View& m_view;
    NearestPhotons& m_scratch;
    SampleRadiance m_result;
};

}  // namespace pm
