// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/gather_focus.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
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
constexpr double kShareInFocus = 0.9;
// Scenes less wide than so many times the focus have light enough in it anyway.
constexpr float kFarBeyond = 8.0f;

// Of the rays from the first diffuse surface of each path; infinite where a ray meets nothing.
std::vector<Vec3f> endsOfGatherRays(const Scene& scene, const Camera& camera,
                                    const RenderSettings& settings, const CancelCheck& cancel) {
    const FrameLattice lattice = FrameLattice::fixed(settings, kColumns, kRows);
    std::vector<Vec3f> ends(lattice.size() * kRays, Vec3f(std::numeric_limits<float>::infinity()));
    followPilotPaths(scene, camera, lattice, combineBits(settings.seed, kSeed), cancel,
                     [&](std::size_t path, const PathStop& stop) {
                         if (stop.next != Lobe::kDiffuse) return true;
                         const Frame frame(stop.bsdf.facingShadingNormal());
                         for (std::size_t i = 0; i < kRays; ++i) {
                             const Vec3f direction = normalize(
                                 frame.toWorld(sampleCosineHemisphere(stop.sampler.next2D())));
                             Surface end;
                             if (scene.intersect(rayFrom(stop.surface, direction), end))
                                 ends[path * kRays + i] = end.position;
                         }
                         return false;
                     });
    return ends;
}

template <typename T>
T quantile(std::vector<T> values, double share) {
    const auto at = values.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::ranges::nth_element(values, at);
    return *at;
}

}  // namespace

Focus findGatherFocus(const Scene& scene, const Camera& camera, const RenderSettings& settings,
                      const CancelCheck& cancel) {
    std::vector<Vec3f> ends = endsOfGatherRays(scene, camera, settings, cancel);
    std::erase_if(ends, [](const Vec3f& end) { return !std::isfinite(end.x); });
    if (ends.size() < kFewestEnds) return {};
    Focus focus;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<float> along;
        for (const Vec3f& end : ends) along.push_back(end[axis]);
        focus.centre[axis] = quantile(std::move(along), 0.5);
    }
    std::vector<float> distances;
    for (const Vec3f& end : ends) distances.push_back(length(end - focus.centre));
    const float radius = quantile(std::move(distances), kShareInFocus);
    if (!(radius > 0.0f) || kFarBeyond * radius > static_cast<float>(scene.radius())) return {};
    focus.inverseRadiusSquared = 1.0f / (radius * radius);
    return focus;
}

}  // namespace pm
