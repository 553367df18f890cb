// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Photon maps against path tracing, layer by layer and region by region, in several renders of
// each.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/replicates.h"

namespace pm::test {

// How much is rendered.
struct LookSize {
    std::int32_t frame = 48;                       // pixels, both ways
    std::int32_t region = 8;                       // of a square region
    int renders = 8;                               // independent ones
    std::uint32_t passes = 4;                      // of photons, each time; twice as many of paths
    std::uint32_t photonLevel = 2, pathLevel = 4;  // anti-aliasing
    std::uint64_t photons = 40'000;
    // Of regions only the whole picture is held to: rare light that few paths find takes long to
    // look at again.
    bool ofPictureOnly = false;

    std::vector<Rect> regions() const { return squares(frame, frame, region); }
    RenderSettings settings(IntegratorKind integrator, std::uint64_t seed) const;
};

// What was seen of regions by both.
struct Look {
    std::vector<RegionMeans> photon, path;

    double z(std::size_t region, Layer layer, std::size_t channel) const;
    std::string tell(std::size_t region, Layer layer, std::size_t channel) const;
    Look ofWholeFrame() const { return {wholeFrames(photon), wholeFrames(path)}; }

  private:
    double frameMean(Layer layer, std::size_t channel) const;
};

Look look(const std::shared_ptr<const Scene>& scene, const LookSize& size);
// Photons of one scene against paths of another, which is to be told from it.
Look lookAtTwin(const std::shared_ptr<const Scene>& ofPhotons,
                const std::shared_ptr<const Scene>& ofPaths, const LookSize& size);

// Fails where a layer of the frame is 4 standard errors off, or more.
void expectFrameAgrees(const Look& frame, const std::string& what);

// Regions that are so in the first look are looked at again, all in one render: with other seeds,
// 16 times as many samples of path tracing, and narrower radii. What is beyond again fails.
void lookAgain(const std::shared_ptr<const Scene>& scene, const LookSize& size, const Look& first,
               const std::string& name);

// a += b.
void addFrame(Look& a, const Look& b);

}  // namespace pm::test
