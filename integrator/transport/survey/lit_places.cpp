// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/survey/lit_places.h"

#include <algorithm>
#include <cstddef>
#include <iterator>

#include "integrator/sampling/sampler.h"
#include "integrator/transport/survey/pilot_paths.h"

namespace pm {

namespace {

// Of the frame.
constexpr double kMostPaths = 4096.0;
// Beyond these a path's places count for little.
constexpr std::size_t kMostPlacesOfAPath = 3;

constexpr std::uint64_t kPlaceSeed = 0x706c616365736f66ull;

}  // namespace

std::vector<LitPlace> findLitPlaces(const Scene& scene, const Camera& camera,
                                    const RenderSettings& settings, const CancelCheck& cancel) {
    const FrameLattice lattice = FrameLattice::squares(settings, kMostPaths);
    const bool wholePath = settings.integrator == IntegratorKind::kPath;
    std::vector<std::vector<LitPlace>> found(lattice.size());
    followPilotPaths(
        scene, camera, lattice, combineBits(settings.seed, kPlaceSeed), cancel,
        [&](std::size_t path, const PathStop& stop) {
            if (stop.bsdf.reflectsLamps())
                found[path].push_back({stop.surface, stop.bsdf.facingGeometricNormal()});
            return found[path].size() < kMostPlacesOfAPath &&
                   (wholePath || stop.next != Lobe::kDiffuse);
        });
    std::vector<LitPlace> places;
    for (const auto& some : found) std::ranges::copy(some, std::back_inserter(places));
    return places;
}

}  // namespace pm
