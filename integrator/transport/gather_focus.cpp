// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/gather_focus.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "integrator/sampling/sampler.h"
#include "integrator/sampling/warps.h"
#include "integrator/transport/pilot_paths.h"

namespace pm {

namespace {

constexpr std::size_t kColumns = 24, kRows = 24, kRays = 8;
constexpr std::uint64_t kSeed = 0x666f637573706172ull;
// Fewer ends tell nothing.
constexpr std::size_t kFewestEnds = 32;
// Of the light that is gathered, so much comes from nearest by; and of the places that it comes
// from, so many are in focus.
constexpr double kNearShare = 0.25, kShareInFocus = 0.9;
// Scenes less wide than so many times the focus have light enough in it anyway.
constexpr float kFarBeyond = 8.0f;

// A diffuse surface that light is gathered from.
struct End {
    Vec3f position;
    float way;      // from where it is gathered at, scene units
    double weight;  // the share of the light there that reaches the camera, > 0
};

void addEndsOfRaysFrom(const Scene& scene, const PathStop& stop, std::vector<End>& ends) {
    const Rgb reflected = stop.throughput * stop.bsdf.diffuse();
    const Frame frame(stop.bsdf.facingShadingNormal());
    const auto addEnd = [&](const PathStop& met) {
        const Rgb share = reflected * met.throughput * met.bsdf.diffuse();
        const double weight = double{share.r} + double{share.g} + double{share.b};
        const Vec3f way = met.surface.position - stop.surface.position;
        if (weight > 0) ends.push_back({met.surface.position, length(way), weight});
        return met.next != Lobe::kDiffuse;
    };
    for (std::size_t i = 0; i < kRays; ++i) {
        const Vec3f direction =
            normalize(frame.toWorld(sampleCosineHemisphere(stop.sampler.next2D())));
        followCameraPath(scene, rayFrom(stop.surface, direction), stop.sampler, addEnd);
    }
}

// Of the rays from the first diffuse surface of each path.
std::vector<End> endsOfGatherRays(const Scene& scene, const Camera& camera,
                                  const RenderSettings& settings, const CancelCheck& cancel) {
    const FrameLattice lattice = FrameLattice::fixed(settings, kColumns, kRows);
    std::vector<std::vector<End>> endsOf(lattice.size());
    followPilotPaths(scene, camera, lattice, combineBits(settings.seed, kSeed), cancel,
                     [&](std::size_t path, const PathStop& stop) {
                         if (stop.next != Lobe::kDiffuse) return true;
                         addEndsOfRaysFrom(scene, stop, endsOf[path]);
                         return false;
                     });
    std::vector<End> ends;
    for (const std::vector<End>& some : endsOf) ends.insert(ends.end(), some.begin(), some.end());
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

}  // namespace

Focus findGatherFocus(const Scene& scene, const Camera& camera, const RenderSettings& settings,
                      const CancelCheck& cancel) {
    std::vector<End> ends = endsOfGatherRays(scene, camera, settings, cancel);
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
    if (!(radius > 0.0f) || kFarBeyond * radius > static_cast<float>(scene.radius())) return {};
    focus.inverseRadiusSquared = 1.0f / (radius * radius);
    return focus;
}

}  // namespace pm
