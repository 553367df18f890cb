// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/gather_points.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "integrator/sampling/warps.h"
#include "integrator/transport/final_gather.h"
#include "integrator/transport/path_walk.h"

namespace pm {

namespace {

// Radius of the first pass's mean on the screen, over the lattice's spacing: some 8 points.
constexpr float kScreenRadius = 1.6f;
// ... and in the scene, over the clearance.
constexpr float kReach = 0.7f;
// Radius of the estimate of descended light over the clearance, and its least over that in the
// open.
constexpr float kDescendedReach = 0.25f;
constexpr float kNarrowestDescended = 0.1f;
// Points whose surface leans away more than this (25 degrees) see another half-space.
constexpr float kNormalCosine = 0.9f;
// Height of a point over the plane through the place, relative to its distance: more is another
// surface.
constexpr float kFlatness = 0.1f;
// Cells beyond each side of the frame that hold points too: for samples at the frame's edge and
// those up to 3 pixels beyond, of a group of pixels with a wide filter.
constexpr std::int32_t kMargin = 3;
static_assert(static_cast<float>(kMargin) > kScreenRadius);
// So many cells to a side share one sequence of gather directions, in parts: together their rays
// are as evenly spread as those of one point with all of them.
constexpr std::size_t kTile = 4;

// Random numbers: the stream of the pass's photons, at sequences which these don't use.
constexpr std::uint64_t kPointSequences = std::uint64_t{1} << 40;
constexpr std::uint64_t kRaySequences = std::uint64_t{1} << 41;

std::uint64_t streamOf(std::uint32_t pass) {
    return 2 * std::uint64_t{pass} + 1;
}

std::int32_t cellsAcross(std::int32_t pixels, float spacing) {
    return static_cast<std::int32_t>(std::ceil(static_cast<float>(pixels) / spacing)) + 2 * kMargin;
}

void addTo(std::array<double, 6>& sum, const TwoRadii& radiance) {
    for (int c = 0; c < 3; ++c) {
        sum[static_cast<std::size_t>(c)] += static_cast<double>(radiance.wide[c]);
        sum[static_cast<std::size_t>(c) + 3] += static_cast<double>(radiance.narrow[c]);
    }
}

}  // namespace

GatherPoints::GatherPoints(const Scene& scene, const Camera& camera, const IrradianceSites& sites,
                           const Request& request, const std::atomic<bool>& cancelled)
    : m_scene(scene),
      m_camera(camera),
      m_sites(sites),
      m_request(request),
      m_columns(cellsAcross(request.width, request.spacing)),
      m_rows(cellsAcross(request.height, request.spacing)),
      m_radius(kScreenRadius * request.spacing * request.radiusFactor),
      m_planeTolerance(8.0f * 0x1p-24f * static_cast<float>(scene.radius())) {
    const std::size_t count =
        static_cast<std::size_t>(m_columns) * static_cast<std::size_t>(m_rows);
    m_points.resize(count);
    m_origins.resize(count);
    m_kept = std::make_unique<Kept[]>(count);
    tbb::parallel_for(std::int32_t{0}, m_rows, [&](std::int32_t row) {
        if (cancelled.load(std::memory_order_relaxed)) return;
        for (std::int32_t column = 0; column < m_columns; ++column) tracePoint(column, row);
    });
}

// A path through the cell as camera samples go, up to where it would be scattered diffusely.
void GatherPoints::tracePoint(std::int32_t column, std::int32_t row) {
    const std::size_t index = static_cast<std::size_t>(row) * static_cast<std::size_t>(m_columns) +
                              static_cast<std::size_t>(column);
    Sampler sampler(m_request.seed, streamOf(m_request.pass), kPointSequences + index, 0);
    const Vec2f jitter = sampler.next2D();
    Point& point = m_points[index];
    point.screen = {(static_cast<float>(column - kMargin) + jitter.x) * m_request.spacing,
                    (static_cast<float>(row - kMargin) + jitter.y) * m_request.spacing};
    point.normal = Vec3f(0.0f);
    PathWalk path(
        m_camera.ray(static_cast<double>(point.screen.x), static_cast<double>(point.screen.y)));
    while (true) {
        Surface surface;
        if (!m_scene.intersect(path.ray, surface)) return;
        const Bsdf bsdf(m_scene, surface, -path.ray.direction, Transport::kRadiance,
                        path.throughput);
        if (bsdf.isBlackBody()) return;
        BsdfSample sample;
        const float uLobe = sampler.next1D();
        const bool valid = bsdf.sample(uLobe, sampler.next2D(), sample);
        if (sample.lobe == Lobe::kDiffuse) {
            point.position = surface.position;
            point.normal = bsdf.facingShadingNormal();
            m_origins[index] = {bsdf.facingGeometricNormal(), surface.offset};
            return;
        }
        if (!valid || !path.scatter(surface, bsdf, sample, sampler)) return;
    }
}

GatherPoints::Value GatherPoints::compute(std::size_t index, std::uint64_t& rays) const {
    const auto columns = static_cast<std::size_t>(m_columns);
    const std::size_t column = index % columns, row = index / columns;
    const std::size_t tile = (row / kTile) * columns + column / kTile;
    const std::size_t part = (row % kTile) * kTile + column % kTile;
    const Point& point = m_points[index];
    const Vec3f& geometricNormal = m_origins[index].geometricNormal;
    const Vec3f start = point.position + geometricNormal * m_origins[index].offset;
    const Frame frame(point.normal);
    std::array<double, 6> sum{};
    float clearance = std::numeric_limits<float>::max();
    std::uint32_t lamps = 0;
    const Sampler tileSampler(m_request.seed, streamOf(m_request.pass), kRaySequences + tile, 0);
    Gathered last;
    const auto addLast = [&] {
        endGather(m_sites, last);
        addTo(sum, last.radiance);
    };
    for (std::uint32_t i = 0; i < m_request.rays; ++i) {
        Sampler sampler = tileSampler.at(static_cast<std::uint32_t>(part) * m_request.rays + i);
        const Vec3f direction = normalize(frame.toWorld(sampleCosineHemisphere(sampler.next2D())));
        if (dot(direction, geometricNormal) <= 0.0f) continue;
        const Gathered found = followGather(m_scene, m_sites, {start, direction}, sampler);
        rays += found.rays;
        if (!found.hitAny) {
            lamps += m_scene.seesFarLight(direction);
            continue;
        }
        lamps += found.first.light != kNoLight && dot(direction, found.first.geometricNormal) < 0;
        const float distance = length(found.first.position - point.position);
        clearance = std::min(clearance, std::max(distance, m_planeTolerance));
        addLast();
        last = found;
    }
    addLast();
    const double count = m_request.rays, scale = static_cast<double>(kPi) / count;
    const auto irradiance = [&](std::size_t at) {
        return Rgb(static_cast<float>(sum[at] * scale), static_cast<float>(sum[at + 1] * scale),
                   static_cast<float>(sum[at + 2] * scale));
    };
    TwoRadii total{irradiance(0), irradiance(3)};
    if (m_request.descended)
        total += descended(point.position, geometricNormal, clearance,
                           descendedRadius(point.position, geometricNormal),
                           static_cast<std::uint32_t>(index));
    return {total, static_cast<float>(lamps) / static_cast<float>(count), clearance};
}

float GatherPoints::descendedRadius(const Vec3f& position, const Vec3f& normal) const {
    NearestPhotons scratch;
    return m_request.descendedRadius->at(position, normal, scratch) * m_request.radiusFactor;
}

// Narrower in corners and gaps, where this light, too, changes within their width.
TwoRadii GatherPoints::descended(const Vec3f& position, const Vec3f& normal, float clearance,
                                 float radius, std::uint32_t pattern) const {
    return m_request.descended
        ->withRadius(std::clamp(kDescendedReach * clearance, kNarrowestDescended * radius, radius))
        .at(position, normal, pattern);
}

TwoRadii GatherPoints::descendedAt(const Place& place, std::uint32_t pattern) const {
    if (!m_request.descended) return {};
    const float radius = descendedRadius(place.position, place.geometricNormal);
    const float clearance = probe(place, radius / kDescendedReach);
    return descended(place.position, place.geometricNormal, clearance, radius, pattern);
}

void GatherPoints::fill(std::size_t index) const {
    // Two threads may both come here: they compute and store the same bits.
    std::uint64_t rays = 0;
    const Value value = compute(index, rays);
    const Rgb &wide = value.irradiance.wide, &narrow = value.irradiance.narrow;
    const std::array<float, 8> numbers = {wide.r,   wide.g,   wide.b,          narrow.r,
                                          narrow.g, narrow.b, value.lampShare, value.clearance};
    Kept& kept = m_kept[index];
    for (std::size_t i = 0; i < numbers.size(); ++i)
        kept.numbers[i].store(numbers[i], std::memory_order_relaxed);
    if (kept.ready.exchange(1, std::memory_order_acq_rel) == 0)
        m_raysTraced.fetch_add(rays, std::memory_order_relaxed);
}

// Points within the radius on the screen that lie on the place's surface.
std::size_t GatherPoints::findNear(const Place& place, std::array<Near, kMostNear>& near) const {
    const float perCell = 1.0f / m_request.spacing;
    const auto cellOf = [&](float pixel, std::int32_t cells) {
        const float cell = std::floor(pixel * perCell) + static_cast<float>(kMargin);
        return static_cast<std::int32_t>(std::clamp(cell, -1.0f, static_cast<float>(cells)));
    };
    const std::int32_t x0 = std::max(0, cellOf(place.screen.x - m_radius, m_columns));
    const std::int32_t x1 = std::min(m_columns - 1, cellOf(place.screen.x + m_radius, m_columns));
    const std::int32_t y0 = std::max(0, cellOf(place.screen.y - m_radius, m_rows));
    const std::int32_t y1 = std::min(m_rows - 1, cellOf(place.screen.y + m_radius, m_rows));
    const float inverse = 1.0f / (m_radius * m_radius);
    std::size_t count = 0;
    for (std::int32_t y = y0; y <= y1; ++y) {
        const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(m_columns);
        for (std::int32_t x = x0; x <= x1; ++x) {
            const std::size_t index = row + static_cast<std::size_t>(x);
            const Point& point = m_points[index];
            const float dx = point.screen.x - place.screen.x;
            const float dy = point.screen.y - place.screen.y;
            const float screen = (dx * dx + dy * dy) * inverse;
            if (screen >= 1.0f || dot(point.normal, place.shadingNormal) < kNormalCosine) continue;
            const Vec3f away = point.position - place.position;
            const float height = dot(away, place.geometricNormal);
            const float distanceSquared = lengthSquared(away);
            if (height * height >
                kFlatness * kFlatness * distanceSquared + m_planeTolerance * m_planeTolerance)
                continue;
            if (count < kMostNear) near[count++] = {index, screen, distanceSquared};
        }
    }
    return count;
}

// The clearance straight above the place, or infinity beyond `farthest`. Points in the open, beside
// a gap, see nothing of what makes it one.
float GatherPoints::probe(const Place& place, float farthest) const {
    const Vec3f start = place.position + place.geometricNormal * place.offset;
    Surface above;
    if (!m_scene.intersect({start, place.geometricNormal, farthest}, above))
        return std::numeric_limits<float>::infinity();
    return std::max(length(above.position - place.position), m_planeTolerance);
}

bool GatherPoints::estimate(const Place& place, Estimate& result) const {
    std::array<Near, kMostNear> near;
    const std::size_t count = findNear(place, near);
    if (count == 0) return false;
    // What is near the place is at least as near as this, whichever point it was seen from.
    float clearance = std::numeric_limits<float>::max(), farthestSquared = 0.0f;
    for (std::size_t i = 0; i < count; ++i) {
        const Kept& kept = m_kept[near[i].index];
        if (!kept.ready.load(std::memory_order_acquire)) fill(near[i].index);
        clearance = std::min(clearance, kept.number(7) + std::sqrt(near[i].distanceSquared));
        farthestSquared = std::max(farthestSquared, near[i].distanceSquared);
    }
    // What is so far up that the reach would still be twice the farthest point's makes no
    // difference.
    const float reachOfClearance = kReach * m_request.radiusFactor;
    const float farthest = 2.0f * std::sqrt(farthestSquared) / reachOfClearance;
    clearance = std::min(clearance, probe(place, std::min(clearance, farthest)));
    result.rays = 1;
    const float reach = reachOfClearance * clearance;
    const float inverseReach = 1.0f / (reach * reach);
    float weights = 0, narrowWeights = 0, lamps = 0;
    TwoRadii sum;
    Rgb narrowSum;
    for (std::size_t i = 0; i < count; ++i) {
        // Epanechnikov's kernel over both distances.
        const float q = near[i].screenDistanceSquared + near[i].distanceSquared * inverseReach;
        if (!(q < 1.0f)) continue;
        const float weight = 1.0f - q, narrowWeight = std::max(0.0f, 1.0f - 2.0f * q);
        weights += weight;
        narrowWeights += narrowWeight;
        const Value value = m_kept[near[i].index].value();
        lamps += value.lampShare * weight;
        sum += {value.irradiance.wide * weight, value.irradiance.narrow * weight};
        narrowSum += value.irradiance.narrow * narrowWeight;
    }
    if (!(weights > 0.0f)) return false;
    result.lampShare = lamps / weights;
    result.irradiance.wide = sum.wide / weights;
    result.irradiance.narrow =
        narrowWeights > 0.0f ? narrowSum / narrowWeights : sum.narrow / weights;
    return true;
}

std::uint64_t GatherPoints::memoryBytes(std::int32_t width, std::int32_t height, float spacing) {
    return static_cast<std::uint64_t>(cellsAcross(width, spacing)) *
           static_cast<std::uint64_t>(cellsAcross(height, spacing)) *
           (sizeof(Point) + sizeof(Origin) + sizeof(Kept));
}

}  // namespace pm
