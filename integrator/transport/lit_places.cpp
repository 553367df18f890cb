// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/lit_places.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "integrator/materials/bsdf.h"
#include "integrator/sampling/sampler.h"
#include "integrator/transport/path_walk.h"

namespace pm {

namespace {

// Pixels to a path where the frame is small, and paths where it is large.
constexpr double kPixelsOfAPath = 9.0;
constexpr double kMostPaths = 4096.0;
// Beyond these a path's places count for little.
constexpr std::size_t kMostPlacesOfAPath = 3;

constexpr std::uint64_t kPlaceSeed = 0x706c616365736f66ull;

std::vector<LitPlace> alongPath(const Scene& scene, const Ray& ray, bool wholePath,
                                Sampler& sampler) {
    std::vector<LitPlace> places;
    PathWalk path(ray);
    Surface surface;
    while (scene.intersect(path.ray, surface)) {
        const Bsdf bsdf(scene, surface, -path.ray.direction, Transport::kRadiance, path.throughput);
        if (bsdf.isBlackBody()) break;
        if (bsdf.has(Lobe::kDiffuse) || bsdf.has(Lobe::kGlossy))
            places.push_back({surface, bsdf.facingGeometricNormal()});
        if (places.size() == kMostPlacesOfAPath) break;
        BsdfSample sample;
        const float uLobe = sampler.next1D();
        if (!bsdf.sample(uLobe, sampler.next2D(), sample)) break;
        if (sample.lobe == Lobe::kDiffuse && !wholePath) break;
        if (!path.scatter(surface, bsdf, sample, sampler)) break;
    }
    return places;
}

}  // namespace

std::vector<LitPlace> findLitPlaces(const Scene& scene, const Camera& camera,
                                    const RenderSettings& settings) {
    const double pixels = static_cast<double>(settings.width) * settings.height;
    const double spacing = std::sqrt(std::max(kPixelsOfAPath, pixels / kMostPaths));
    const auto columns = static_cast<std::size_t>(std::ceil(settings.width / spacing));
    const auto rows = static_cast<std::size_t>(std::ceil(settings.height / spacing));
    const std::uint64_t seed = combineBits(settings.seed, kPlaceSeed);
    std::vector<std::vector<LitPlace>> found(columns * rows);
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t i) {
        Sampler sampler(seed, 0, i, 0);
        const Vec2f jitter = sampler.next2D();
        const double x = (static_cast<double>(i % columns) + static_cast<double>(jitter.x));
        const double y = (static_cast<double>(i / columns) + static_cast<double>(jitter.y));
        found[i] = alongPath(scene, camera.ray(x * spacing, y * spacing),
                             settings.integrator == IntegratorKind::kPath, sampler);
    });
    std::vector<LitPlace> places;
    for (const auto& some : found) std::ranges::copy(some, std::back_inserter(places));
    return places;
}

}  // namespace pm
