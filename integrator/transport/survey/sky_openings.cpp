// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/survey/sky_openings.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>

#include "integrator/photons/emission/sky_parts.h"
#include "integrator/sampling/sampler.h"
#include "integrator/sampling/warps.h"
#include "integrator/transport/survey/pilot_paths.h"

namespace pm {

namespace {

constexpr std::size_t kColumns = 32, kRows = 32;
// From where each path ends; more where those find something, but little.
constexpr std::uint32_t kLooks = 64, kMoreLooks = 2048;
constexpr std::uint64_t kSeed = 0x736b796f70656e69ull;
// Fewer rays tell nothing; of more than the most some are left out.
constexpr std::size_t kFewestRays = 64, kMostRays = 2048;
constexpr std::size_t kMostOpenings = 4;
// An opening is crossed by at least this share of the rays, all of them by at least that.
constexpr double kLeastShare = 0.05, kLeastOfAll = 0.8;
// Its radius over the scene's at most; and the share of an opening's rays that its ball holds.
constexpr double kWidest = 0.25, kShareInBall = 0.95;
// Balls whose shadows fill more of the scene's than this are not worth it.
constexpr double kMostOfScene = 0.25;
constexpr std::uint32_t kTrials = 128;

struct SkyRay {
    Vec3d origin, direction;  // direction: unit
};

// Squared distance of a point from the ray's line; nothing where it lies behind the origin.
std::optional<double> distanceSquared(const SkyRay& ray, const Vec3d& point) {
    const Vec3d way = point - ray.origin;
    const double along = dot(way, ray.direction);
    if (!(along > 0)) return std::nullopt;
    return std::max(0.0, lengthSquared(way) - along * along);
}

// The middle between two lines where they are nearest.
std::optional<Vec3d> meeting(const SkyRay& a, const SkyRay& b) {
    const double cosine = dot(a.direction, b.direction), sine2 = 1 - cosine * cosine;
    if (!(sine2 > 0.01)) return std::nullopt;
    const Vec3d way = b.origin - a.origin;
    const double x = dot(way, a.direction), y = dot(way, b.direction);
    const double s = (x - cosine * y) / sine2, t = (cosine * x - y) / sine2;
    if (!(s > 0 && t > 0)) return std::nullopt;
    return (a.origin + a.direction * s + b.origin + b.direction * t) * 0.5;
}

// The point whose squared distances from these lines add up to the least.
std::optional<Vec3d> nearestPoint(const std::vector<SkyRay>& rays) {
    // Sum of (1 - d d^T) x = sum of (1 - d d^T) o.
    double m[3][4] = {};
    for (const SkyRay& ray : rays)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                const double p = (i == j ? 1.0 : 0.0) - ray.direction[i] * ray.direction[j];
                m[i][j] += p;
                m[i][3] += p * ray.origin[j];
            }
    // Symmetric and not negative: no pivoting.
    for (int i = 0; i < 3; ++i) {
        if (!(m[i][i] > 1e-6 * static_cast<double>(rays.size()))) return std::nullopt;
        for (int k = 0; k < 3; ++k) {
            if (k == i) continue;
            const double factor = m[k][i] / m[i][i];
            for (int j = i; j < 4; ++j) m[k][j] -= factor * m[i][j];
        }
    }
    return Vec3d{m[0][3] / m[0][0], m[1][3] / m[1][1], m[2][3] / m[2][2]};
}

std::vector<SkyRay> raysThrough(const std::vector<SkyRay>& rays, const Vec3d& centre,
                                double radius) {
    std::vector<SkyRay> found;
    for (const SkyRay& ray : rays)
        if (const auto d2 = distanceSquared(ray, centre); d2 && *d2 < radius * radius)
            found.push_back(ray);
    return found;
}

double radiusAround(const std::vector<SkyRay>& rays, const Vec3d& centre) {
    std::vector<double> squares;
    for (const SkyRay& ray : rays)
        if (const auto d2 = distanceSquared(ray, centre)) squares.push_back(*d2);
    const auto at = squares.begin() + static_cast<std::ptrdiff_t>(
                                          kShareInBall * static_cast<double>(squares.size() - 1));
    std::nth_element(squares.begin(), at, squares.end());
    return std::sqrt(*at);
}

// The ball around where the most rays come close to each other.
std::optional<Caster> findBall(const std::vector<SkyRay>& rays, double widest,
                               const Sampler& sampler) {
    std::vector<SkyRay> best;
    for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
        const Vec2f u = sampler.branch(trial).get2D(Purpose::kPilot);
        const auto one = [&](float v) -> const SkyRay& {
            return rays[std::min(
                static_cast<std::size_t>(static_cast<double>(v) * static_cast<double>(rays.size())),
                rays.size() - 1)];
        };
        const auto centre = meeting(one(u.x), one(u.y));
        if (!centre) continue;
        std::vector<SkyRay> near = raysThrough(rays, *centre, widest / 2);
        if (near.size() > best.size()) best = std::move(near);
    }
    if (best.size() < 3) return std::nullopt;
    Caster ball;
    for (int step = 0; step < 3; ++step) {
        const auto centre = nearestPoint(best);
        if (!centre) return std::nullopt;
        ball.centre = *centre;
        best = raysThrough(rays, ball.centre, widest);
        if (best.size() < 3) return std::nullopt;
    }
    ball.radius = radiusAround(best, ball.centre);
    return ball;
}

// Every n-th.
std::vector<SkyRay> someOf(const std::vector<SkyRay>& rays, std::size_t most) {
    const std::size_t step = (rays.size() + most - 1) / most;
    std::vector<SkyRay> some;
    for (std::size_t i = 0; i < rays.size(); i += step) some.push_back(rays[i]);
    return some;
}

struct Looks {
    std::vector<SkyRay> rays;
    std::vector<float> seenShare;
    SkyLooks counted;
};

Looks lookAtSky(const Scene& scene, const Camera& camera, const RenderSettings& settings,
                std::uint32_t count, const CancelCheck& cancel) {
    const FrameLattice lattice = FrameLattice::fixed(settings, kColumns, kRows);
    struct OfPath {
        std::vector<SkyRay> rays;
        std::size_t asked = 0;
    };
    std::vector<OfPath> ofPath(lattice.size());
    followPilotPaths(scene, camera, lattice, combineBits(settings.seed, kSeed), cancel,
                     [&](std::size_t path, const PathStop& stop) {
                         if (stop.next != Lobe::kDiffuse) return true;
                         const Vec3f normal = stop.bsdf.facingShadingNormal();
                         const Vec2f start = stop.sampler.get2D(Purpose::kPilot);
                         for (std::uint32_t i = 0; i < count; ++i) {
                             float pdf;
                             const Vec3f direction =
                                 scene.environment().sample(spreadPoint(i, start), pdf);
                             if (!(dot(direction, normal) > 0.0f)) continue;
                             ++ofPath[path].asked;
                             if (isBlack(scene.skyRadiance(stop.surface, normal, direction)))
                                 continue;
                             ofPath[path].rays.push_back(
                                 {Vec3d(stop.surface.position), normalize(Vec3d(direction))});
                         }
                         return false;
                     });
    Looks looks;
    for (const OfPath& one : ofPath) {
        looks.counted.asked += one.asked;
        looks.counted.seen += one.rays.size();
        looks.rays.insert(looks.rays.end(), one.rays.begin(), one.rays.end());
    }
    looks.seenShare.resize(SkyParts::kCount);
    for (const SkyRay& ray : looks.rays)
        looks.seenShare[SkyParts::partOf(Vec3f(ray.direction))] +=
            1.0f / static_cast<float>(looks.rays.size());
    return looks;
}

}  // namespace

SkyOpenings findSkyOpenings(const Scene& scene, const Camera& camera,
                            const RenderSettings& settings, const CancelCheck& cancel) {
    if (!scene.hasEnvironment()) return {};
    Looks looks = lookAtSky(scene, camera, settings, kLooks, cancel);
    if (!looks.rays.empty() && looks.rays.size() < kFewestRays)
        looks = lookAtSky(scene, camera, settings, kMoreLooks, cancel);
    if (!looks.counted.isHidden() || looks.rays.size() < kFewestRays) return {};
    looks.rays = someOf(looks.rays, kMostRays);
    const std::size_t all = looks.rays.size();
    Sampler sampler(combineBits(settings.seed, kSeed), 1, 0, 0);
    SkyOpenings openings{{}, std::move(looks.seenShare)};
    double area = 0;
    while (openings.balls.size() < kMostOpenings && looks.rays.size() >= 3) {
        const auto ball = findBall(looks.rays, kWidest * scene.radius(), sampler);
        sampler.nextEvent();
        if (!ball) break;
        const std::size_t before = looks.rays.size();
        std::erase_if(looks.rays, [&](const SkyRay& ray) {
            const auto d2 = distanceSquared(ray, ball->centre);
            return d2 && *d2 < ball->radius * ball->radius;
        });
        const auto crossed = static_cast<double>(before - looks.rays.size());
        if (crossed < kLeastShare * static_cast<double>(all)) break;
        openings.balls.push_back(*ball);
        area += std::numbers::pi * ball->radius * ball->radius;
    }
    const double left = static_cast<double>(looks.rays.size()) / static_cast<double>(all);
    const double whole = std::numbers::pi * scene.radius() * scene.radius();
    if (left > 1 - kLeastOfAll || area > kMostOfScene * whole) return {};
    return openings;
}

}  // namespace pm
