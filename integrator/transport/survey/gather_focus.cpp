// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/survey/gather_focus.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "integrator/sampling/sampler.h"
#include "integrator/sampling/warps.h"
#include "integrator/transport/survey/pilot_paths.h"

namespace pm {

namespace {

constexpr std::size_t kColumns = 24, kRows = 24, kRays = 8;
// Where something is found, but little, the lattice is made finer, to so many times as many paths
// across and down.
constexpr std::size_t kFinest = 8;
constexpr std::uint64_t kSeed = 0x666f637573706172ull;
// Fewer ends tell nothing.
constexpr std::size_t kFewestEnds = 32;
// Of the light that is gathered, so much comes from nearest by; and of the places that it comes
// from, so many are in focus.
constexpr double kNearShare = 0.25, kShareInFocus = 0.9;
// Scenes less wide than so many times the focus have light enough in it anyway.
constexpr float kFarBeyond = 8.0f;

// A diffuse surface that light is gathered from, or seen at.
struct End {
    Vec3f position;
    float way;      // from where it is gathered at, or from the camera, scene units
    double weight;  // the share of the light there that reaches the camera, > 0
};

double weightOf(const Rgb& share) {
    return double{share.r} + double{share.g} + double{share.b};
}

void addEndsOfRaysFrom(const Scene& scene, const PathStop& stop, std::vector<End>& ends) {
    const Rgb reflected = stop.throughput * stop.bsdf.diffuse();
    const Frame frame(stop.bsdf.facingShadingNormal());
    const auto addEnd = [&](const PathStop& met) {
        const Rgb share = reflected * met.throughput * met.bsdf.diffuse();
        const double weight = weightOf(share);
        const Vec3f way = met.surface.position - stop.surface.position;
        if (weight > 0) ends.push_back({met.surface.position, length(way), weight});
        return met.next != Lobe::kDiffuse;
    };
    for (std::uint32_t i = 0; i < kRays; ++i) {
        Sampler random = stop.sampler.branch(i);
        const Vec3f direction =
            normalize(frame.toWorld(sampleCosineHemisphere(random.get2D(Purpose::kDirection))));
        random.nextEvent();
        followCameraPath(scene, rayFrom(stop.surface, direction),
                         scene.coneAround(direction, stop.footprint.width()), random, addEnd);
    }
}

// Of the first diffuse surface of each path, or of the rays from there. addEnds: of one such.
template <typename AddEnds>
std::vector<End> endsOfPaths(const Scene& scene, const Camera& camera,
                             const RenderSettings& settings, const CancelCheck& cancel,
                             const AddEnds& addEnds) {
    std::vector<End> ends;
    for (std::size_t finer = 1; finer <= kFinest; finer *= 2) {
        const FrameLattice lattice = FrameLattice::fixed(settings, finer * kColumns, finer * kRows);
        std::vector<std::vector<End>> endsOf(lattice.size());
        followPilotPaths(scene, camera, lattice, combineBits(settings.seed, kSeed), cancel,
                         [&](std::size_t path, const PathStop& stop) {
                             if (!stop.isGathered()) return stop.goesOn();
                             addEnds(stop, endsOf[path]);
                             return false;
                         });
        ends.clear();
        for (const auto& some : endsOf) ends.insert(ends.end(), some.begin(), some.end());
        if (ends.empty() || ends.size() >= kFewestEnds) break;
    }
    return ends;
}

// The least of the values that, with those below, have this share of the ends' weight.
template <typename ValueOf>
float quantile(const std::vector<End>& ends, double share, const ValueOf& valueOf) {
    std::vector<std::pair<float, double>> weighed;
    for (const End& end : ends) weighed.emplace_back(valueOf(end), end.weight);
    std::ranges::sort(weighed);
    double left = 0;
    for (const auto& [value, weight] : weighed) left += weight;
    left *= share;
    for (const auto& [value, weight] : weighed)
        if (left -= weight; left <= 0) return value;
    return weighed.back().first;
}

// The ball that holds most of what is near.
Focus focusOf(std::vector<End> ends, float sceneRadius) {
    if (ends.size() < kFewestEnds) return {};
    // What is far may be seen from everywhere: it needs no more photons than its part of the view
    // has. What is near needs them close together.
    const float near = quantile(ends, kNearShare, [](const End& end) { return end.way; });
    std::erase_if(ends, [&](const End& end) { return end.way > near; });
    Focus focus;
    for (int axis = 0; axis < 3; ++axis)
        focus.centre[axis] =
            quantile(ends, 0.5, [&](const End& end) { return end.position[axis]; });
    const float radius = quantile(
        ends, kShareInFocus, [&](const End& end) { return length(end.position - focus.centre); });
    if (!(radius > 0.0f) || kFarBeyond * radius > sceneRadius) return {};
    focus.inverseRadiusSquared = 1.0f / (radius * radius);
    return focus;
}

}  // namespace

Focus findGatherFocus(const Scene& scene, const Camera& camera, const RenderSettings& settings,
                      const CancelCheck& cancel) {
    return focusOf(endsOfPaths(scene, camera, settings, cancel,
                               [&](const PathStop& stop, std::vector<End>& ends) {
                                   addEndsOfRaysFrom(scene, stop, ends);
                               }),
                   static_cast<float>(scene.radius()));
}

Focus findSeenFocus(const Scene& scene, const Camera& camera, const RenderSettings& settings,
                    const CancelCheck& cancel) {
    return focusOf(endsOfPaths(scene, camera, settings, cancel,
                               [&](const PathStop& stop, std::vector<End>& ends) {
                                   const double weight =
                                       weightOf(stop.throughput * stop.bsdf.diffuse());
                                   const Vec3f& at = stop.surface.position;
                                   if (weight > 0)
                                       ends.push_back({at, std::abs(camera.depth(at)), weight});
                               }),
                   static_cast<float>(scene.radius()));
}

}  // namespace pm
