// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/scene/camera.h"
#include "integrator/transport/photon/photon_pass.h"
#include "tests/support/scene_maker.h"

namespace pm::test {

// What is compared: the layers, and the beauty with its estimated bias taken off (the bias of the
// wider radii is twice what narrowing them by sqrt(2) changes).
enum Layer : std::size_t {
    kBeauty,
    kEmission,
    kDirect,
    kCaustic,
    kIndirect,
    kCorrected,
    kLayerCount
};
constexpr std::array<const char*, kLayerCount> kLayerNames = {
    "beauty", "emission", "direct", "caustic", "indirect", "beauty less bias"};

// Mean of every layer over a region.
using LayerMeans = std::array<std::array<double, 3>, kLayerCount>;
// Of several regions of one render.
using RegionMeans = std::vector<LayerMeans>;

// A number measured in several independent renders.
struct Replicated {
    double mean = 0, standardError = 0;
    int count = 0;
};

// Squares of the frame, size pixels wide, row by row.
std::vector<Rect> squares(std::int32_t width, std::int32_t height, std::int32_t size);

// One render of as many passes as the settings have, from firstPass on.
RegionMeans render(const std::shared_ptr<const Scene>& scene, const RenderSettings& settings,
                   const std::vector<Rect>& regions, std::uint32_t firstPass = 0);

// Of the first render of several: 1, or PM_FIRST_SEED of the environment, to see how much hangs on
// it.
std::uint64_t firstSeed();

// Independent renders: the seeds are firstSeed() and those after it.
std::vector<RegionMeans> replicate(int count,
                                   const std::function<RegionMeans(std::uint64_t seed)>& render);

// The mean of all regions, which are of one size, in place of them.
std::vector<RegionMeans> wholeFrames(const std::vector<RegionMeans>& renders);

Replicated spread(const std::vector<RegionMeans>& renders, std::size_t region, Layer layer,
                  std::size_t channel);

// How many standard errors a and b differ by, beyond what is allowed: the standard normal number as
// rare as Student's t with Welch's degrees of freedom is. Source: Wallace 1959, for t to z.
double zScore(const Replicated& a, const Replicated& b, double allowed);

// Fails where the largest z over regions and channels is not below `limit`; returns it. `allowed`
// is relative to the larger of b and the mean of b over all regions.
double expectAgreement(const std::vector<RegionMeans>& a, const std::vector<RegionMeans>& b,
                       Layer layer, double allowed, double limit, const std::string& what);

// Renders as FrameRenderer does, but by a plan that a test may have changed, and with some of the
// maps left out of what the camera reads.
class PlannedRender {
  public:
    PlannedRender(std::shared_ptr<const Scene> scene, const RenderSettings& settings,
                  const Plan& plan);

    PhotonPass& photons() { return m_photons; }
    const Scene& scene() const { return *m_scene; }
    // As FrameRenderer::beginPass.
    void begin(std::uint32_t pass);
    // A sample of pixel (x, y), of the pass that was begun, by the maps given.
    SampleRadiance sample(std::int32_t x, std::int32_t y, std::uint32_t index,
                          const PhotonMaps& maps, NearestPhotons& scratch) const;
    // The mean over regions of samples `samples` a pixel of that pass.
    RegionMeans means(const std::vector<Rect>& regions, std::uint32_t samples,
                      const PhotonMaps& maps) const;
    // All passes of the settings.
    RegionMeans render(const std::vector<Rect>& regions, std::uint32_t samples);

  private:
    std::shared_ptr<const Scene> m_scene;
    RenderSettings m_settings;
    Plan m_plan;
    Camera m_camera;
    LightSampler m_lights;
    PhotonPass m_photons;
    std::uint32_t m_pass = 0;
};

// a += b * scale.
void addTo(RegionMeans& a, const RegionMeans& b, double scale);

}  // namespace pm::test
