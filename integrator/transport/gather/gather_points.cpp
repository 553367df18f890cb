// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/gather/gather_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "integrator/sampling/warps.h"
#include "integrator/transport/gather/final_gather.h"
#include "integrator/transport/gather/surroundings.h"
#include "integrator/transport/path/camera_step.h"

namespace pm {

namespace {

// Radius of the first pass's mean on the screen, over the lattice's spacing: some 8 points.
constexpr float kScreenRadius = 1.6f;
// ... and in the scene, over the clearance.
constexpr float kReach = 1.0f;
// Radius of the estimate of refocused light over the clearance, and its least over that in the
// open.
constexpr float kRefocusedReach = 0.25f;
constexpr float kNarrowestRefocused = 0.3f;
// Points nearer than this, over the clearance, are taken as in sight; others look for the place
// from a height of so much of the way, or of their headroom, whichever is less.
constexpr float kSurelySeen = 0.25f;
constexpr float kLift = 0.05f, kLiftOfHeadroom = 0.5f;
// Points whose surface leans away more than this (25 degrees) see another half-space.
constexpr float kNormalCosine = 0.9f;
// Height of a point over the plane through the place, relative to its distance: more is another
// surface.
constexpr float kFlatness = 0.1f;
static_assert(static_cast<float>(PointTiles::kMargin) > kScreenRadius);
// So many cells to a side share one sequence of gather directions, in parts: together their rays
// are as evenly spread as those of one point with all of them.
constexpr std::size_t kShared = 4;

// Random numbers: the stream of the pass's photons, at sequences which these don't use.
constexpr std::uint64_t kPointSequences = std::uint64_t{1} << 40;
constexpr std::uint64_t kRaySequences = std::uint64_t{1} << 41;
constexpr std::uint64_t kLampSequences = std::uint64_t{1} << 42;

std::uint64_t streamOf(std::uint32_t pass) {
    return 2 * std::uint64_t{pass} + 1;
}

PointTiles tilesOf(std::int32_t width, std::int32_t height, float spacing, float factor = 1.0f) {
    return {width, height, spacing, kScreenRadius * spacing * factor};
}

void addTo(std::array<double, 6>& sum, const TwoRadii& radiance) {
    for (int c = 0; c < 3; ++c) {
        sum[static_cast<std::size_t>(c)] += static_cast<double>(radiance.wide[c]);
        sum[static_cast<std::size_t>(c) + 3] += static_cast<double>(radiance.narrow[c]);
    }
}

}  // namespace

GatherPoints::GatherPoints(const Scene& scene, const Camera& camera, const IrradianceSites& sites,
                           const Request& request)
    : m_scene(scene),
      m_camera(camera),
      m_sites(sites),
      m_request(request),
      m_radius(kScreenRadius * request.spacing * request.radiusFactor),
      m_tiles(tilesOf(request.width, request.height, request.spacing, request.radiusFactor)),
      m_slots(std::make_unique<TileSlot[]>(m_tiles.count())) {}

GatherPoints::~GatherPoints() {
    for (std::size_t i = 0; i < m_tiles.count(); ++i) delete m_slots[i].tile.load();
}

// Two threads may both come here: they make the same tile, and one of the two is kept.
GatherPoints::Tile* GatherPoints::tileAt(std::size_t slot) const {
    std::atomic<Tile*>& kept = m_slots[slot].tile;
    if (Tile* const found = kept.load(std::memory_order_acquire)) return found;
    auto made = std::make_unique<Tile>();
    constexpr auto side = static_cast<std::size_t>(PointTiles::kSide);
    const auto across = static_cast<std::size_t>(m_tiles.across());
    const std::size_t left = slot % across * side, top = slot / across * side;
    const std::size_t right = std::min(left + side, static_cast<std::size_t>(m_tiles.columns()));
    const std::size_t bottom = std::min(top + side, static_cast<std::size_t>(m_tiles.rows()));
    for (std::size_t row = top; row < bottom; ++row)
        for (std::size_t column = left; column < right; ++column) tracePoint(*made, {column, row});
    Tile* other = nullptr;
    if (!kept.compare_exchange_strong(other, made.get(), std::memory_order_acq_rel)) return other;
    const std::size_t held = ++m_tilesHeld;
    std::size_t most = m_mostTilesHeld;
    while (most < held && !m_mostTilesHeld.compare_exchange_weak(most, held)) {
    }
    return made.release();
}

void GatherPoints::forget(const Rect& region, const Rect& all) const {
    const Rect tiles = m_tiles.asked(region);
    for (std::int32_t y = tiles.y0; y < tiles.y1; ++y)
        for (std::int32_t x = tiles.x0; x < tiles.x1; ++x) {
            const std::size_t index =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(m_tiles.across()) +
                static_cast<std::size_t>(x);
            const Rect reach = m_tiles.reach(index);
            const std::int64_t done = intersect(reach, region).area();
            TileSlot& slot = m_slots[index];
            if (done == 0 || slot.donePixels.fetch_add(done, std::memory_order_acq_rel) + done !=
                                 intersect(reach, all).area())
                continue;
            if (const Tile* const tile = slot.tile.exchange(nullptr)) {
                delete tile;
                --m_tilesHeld;
            }
        }
}

// A path through the cell to a surface with a diffuse lobe: to the first in half of the cells at
// least, as samples ask there as often as where its other lobes lead.
void GatherPoints::tracePoint(Tile& tile, const Cell& cell) const {
    const std::size_t index = cell.row * static_cast<std::size_t>(m_tiles.columns()) + cell.column;
    const Sampler sampler(m_request.seed, streamOf(m_request.pass), kPointSequences + index, 0);
    const Vec2f jitter = sampler.get2D(Purpose::kPlace);
    const auto start = [](std::size_t at) {
        return static_cast<float>(static_cast<std::int32_t>(at) - PointTiles::kMargin);
    };
    Point& point = tile.points[cell.inTile()];
    point.screen = {(start(cell.column) + jitter.x) * m_request.spacing,
                    (start(cell.row) + jitter.y) * m_request.spacing};
    point.normal = Vec3f(0.0f);
    const auto x = static_cast<double>(point.screen.x), y = static_cast<double>(point.screen.y);
    const Ray first = m_camera.ray({x, y});
    followCameraPath(
        m_scene, first, m_camera.footprint({x, y}, first), sampler, [&](const PathStop& stop) {
            const bool chosen =
                stop.bsdf.has(Lobe::kDiffuse) && stop.sampler.get1D(Purpose::kPilot) < 0.5f;
            if (!stop.isGathered() && !chosen) return stop.goesOn();
            const std::optional<Admission> admission = stop.bsdf.admission();
            if (!admission) return false;
            const Vec3f& normal = stop.bsdf.facingGeometricNormal();
            point.position = m_scene.pointUnderRay(stop.surface.position, stop.ray, normal);
            point.normal = stop.bsdf.facingShadingNormal();
            point.admits = admitsOf(*admission, stop.surface.material);
            tile.origins[cell.inTile()] = {normal, stop.surface.offset, stop.footprint.width(),
                                           *admission};
            return false;
        });
}

// The point's part of the directions that it shares.
GatherPoints::Value GatherPoints::gather(const Point& point, const Origin& origin,
                                         const Sampler& shared, std::size_t part,
                                         std::uint64_t& rays) const {
    const Vec3f& geometricNormal = origin.geometricNormal;
    const float least = planeTolerance(point.position);
    const Frame frame(point.normal);
    const auto directions = directionsAt(point.position, frame);
    std::array<double, 6> sum{};
    float clearance = std::numeric_limits<float>::max();
    float lamps = 0;
    Gathered last;
    GatherEnds ends{m_sites, m_request.caustics, m_request.rays, m_request.lights};
    ends.width = origin.width;
    ends.findsRefocused = !m_request.refocused;
    const auto addLast = [&] {
        endGather(ends, last);
        addTo(sum, last.radiance);
    };
    for (std::uint32_t i = 0; i < m_request.rays; ++i) {
        Sampler sampler = shared.at(static_cast<std::uint32_t>(part) * m_request.rays + i);
        const auto [u, density] = GatherGuide::warp(directions, sampler.get2D(Purpose::kDirection));
        sampler.nextEvent();
        const float weight = 1 / density;
        const Vec3f direction = normalize(frame.toWorld(sampleCosineHemisphere(u)));
        if (dot(direction, geometricNormal) <= 0.0f) continue;
        Gathered found = followGather(
            m_scene, ends, m_scene.rayOnwards(point.position, geometricNormal, direction),
            dot(direction, point.normal), sampler);
        found.scale(weight * origin.admission.from(dot(direction, point.normal)));
        rays += found.rays;
        if (!found.hitAny) {
            if (m_scene.seesFarLight(direction)) lamps += weight;
            continue;
        }
        if (found.first.light != kNoLight && dot(direction, found.first.geometricNormal) < 0)
            lamps += weight;
        const float distance = length(found.first.position - point.position);
        clearance = std::min(clearance, std::max(distance, least));
        addLast();
        last = found;
    }
    addLast();
    const double count = m_request.rays, scale = static_cast<double>(kPi) / count;
    const auto irradiance = [&](std::size_t at) {
        return Rgb(static_cast<float>(sum[at] * scale), static_cast<float>(sum[at + 1] * scale),
                   static_cast<float>(sum[at + 2] * scale));
    };
    return {{irradiance(0), irradiance(3)}, lamps / static_cast<float>(count), clearance, 0.0f};
}

// The same of all cells that share directions and lamps.
std::size_t GatherPoints::sequenceOf(const Cell& cell) const {
    return (cell.row / kShared) * static_cast<std::size_t>(m_tiles.columns()) +
           cell.column / kShared;
}

// The points that share a sequence have different lamps each, neighbours the most different ones.
Rgb GatherPoints::sampleCaustics(const Point& point, const Origin& origin, const Cell& cell) const {
    static_assert(kShared == 4);
    const auto part = static_cast<std::uint32_t>((cell.column & 1) | (cell.row & 1) << 1 |
                                                 (cell.column & 2) << 1 | (cell.row & 2) << 2);
    const Sampler sampler(m_request.seed, streamOf(m_request.pass),
                          kLampSequences + sequenceOf(cell), part);
    const VirtualLamps::Place place{point.position,
                                    point.position + origin.geometricNormal * origin.offset,
                                    point.normal, origin.geometricNormal, origin.admission};
    return m_request.caustics->sampled(place, m_request.rays, sampler.get1D(Purpose::kCaustic));
}

GatherPoints::Value GatherPoints::compute(const Tile& tile, const Cell& cell,
                                          std::uint64_t& rays) const {
    const auto columns = static_cast<std::size_t>(m_tiles.columns());
    const std::size_t sequence = sequenceOf(cell);
    const std::size_t part = (cell.row % kShared) * kShared + cell.column % kShared;
    const Sampler shared(m_request.seed, streamOf(m_request.pass), kRaySequences + sequence, 0);
    const Origin& origin = tile.origins[cell.inTile()];
    const Vec3f& normal = origin.geometricNormal;
    const Point& point = tile.points[cell.inTile()];
    Value value = gather(point, origin, shared, part, rays);
    ++rays;
    value.headroom = Surroundings(m_scene, point.position, normal, origin.offset, 0.0f)
                         .distanceAlong(normal, value.clearance)
                         .value_or(value.clearance);
    if (m_request.caustics) {
        const Rgb sampled = sampleCaustics(point, origin, cell);
        value.irradiance += {sampled, sampled};
        rays += VirtualLamps::raysBeside(m_request.rays);
    }
    if (m_request.refocused)
        value.irradiance += refocused(point.position, normal, value.clearance,
                                      refocusedRadius(point.position, normal),
                                      static_cast<std::uint32_t>(cell.row * columns + cell.column));
    return value;
}

// Radius of the mean in the scene over the clearance, in this pass.
float GatherPoints::reachOfClearance() const {
    return kReach * m_request.radiusFactor;
}

float GatherPoints::planeTolerance(const Vec3f& position) const {
    return 8.0f * 0x1p-24f * m_scene.roundingRadius(position);
}

Surroundings GatherPoints::surroundingsOf(const Place& place) const {
    return {m_scene, place.position, place.geometricNormal, place.offset,
            planeTolerance(place.position)};
}

float GatherPoints::refocusedRadius(const Vec3f& position, const Vec3f& normal) const {
    NearestPhotons scratch;
    return m_request.refocusedRadius->at(position, normal, scratch) * m_request.radiusFactor;
}

// Narrower in corners and gaps, where this light, too, changes within their width.
TwoRadii GatherPoints::refocused(const Vec3f& position, const Vec3f& normal, float clearance,
                                 float radius, std::uint32_t pattern) const {
    return m_request.refocused
        ->withRadius(std::clamp(kRefocusedReach * clearance, kNarrowestRefocused * radius, radius))
        .at(position, normal, pattern);
}

TwoRadii GatherPoints::refocusedAt(const Place& place, float clearance,
                                   std::uint32_t pattern) const {
    if (!m_request.refocused) return {};
    const float radius = refocusedRadius(place.position, place.geometricNormal);
    if (!std::isfinite(clearance))
        clearance = surroundingsOf(place).clearance(radius / kRefocusedReach, pattern);
    return refocused(place.position, place.geometricNormal, clearance, radius, pattern);
}

void GatherPoints::fill(Tile& tile, const Cell& cell) const {
    // Two threads may both come here: they compute and store the same bits.
    std::uint64_t rays = 0;
    const Value value = compute(tile, cell, rays);
    const Rgb &wide = value.irradiance.wide, &narrow = value.irradiance.narrow;
    const std::array<float, 9> numbers = {wide.r,          wide.g,          wide.b,
                                          narrow.r,        narrow.g,        narrow.b,
                                          value.lampShare, value.clearance, value.headroom};
    Kept& kept = tile.kept[cell.inTile()];
    for (std::size_t i = 0; i < numbers.size(); ++i)
        kept.numbers[i].store(numbers[i], std::memory_order_relaxed);
    if (kept.ready.exchange(1, std::memory_order_acq_rel) == 0)
        m_raysTraced.fetch_add(rays, std::memory_order_relaxed);
}

// Points within the radius on the screen that lie on the place's surface.
std::size_t GatherPoints::findNear(const Place& place, std::array<Near, kMostNear>& near) const {
    const float perCell = 1.0f / m_request.spacing;
    const auto cellOf = [&](float pixel, std::int32_t cells) {
        const float cell = std::floor(pixel * perCell) + static_cast<float>(PointTiles::kMargin);
        return static_cast<std::int32_t>(std::clamp(cell, -1.0f, static_cast<float>(cells)));
    };
    const std::int32_t x0 = std::max(0, cellOf(place.screen.x - m_radius, m_tiles.columns()));
    const std::int32_t x1 =
        std::min(m_tiles.columns() - 1, cellOf(place.screen.x + m_radius, m_tiles.columns()));
    const std::int32_t y0 = std::max(0, cellOf(place.screen.y - m_radius, m_tiles.rows()));
    const std::int32_t y1 =
        std::min(m_tiles.rows() - 1, cellOf(place.screen.y + m_radius, m_tiles.rows()));
    const float inverse = 1.0f / (m_radius * m_radius);
    const float tolerance = planeTolerance(place.position);
    std::size_t count = 0;
    Tile* tile = nullptr;
    std::size_t slot = 0;
    for (std::int32_t y = y0; y <= y1; ++y) {
        const std::size_t firstSlot = static_cast<std::size_t>(y / PointTiles::kSide) *
                                      static_cast<std::size_t>(m_tiles.across());
        for (std::int32_t x = x0; x <= x1; ++x) {
            const std::size_t needed = firstSlot + static_cast<std::size_t>(x / PointTiles::kSide);
            if (!tile || slot != needed) tile = tileAt(slot = needed);
            const Cell cell{static_cast<std::size_t>(x), static_cast<std::size_t>(y)};
            const Point& point = tile->points[cell.inTile()];
            const float dx = point.screen.x - place.screen.x;
            const float dy = point.screen.y - place.screen.y;
            const float screen = (dx * dx + dy * dy) * inverse;
            if (screen >= 1.0f || point.admits != place.admits ||
                dot(point.normal, place.shadingNormal) < kNormalCosine)
                continue;
            const Vec3f away = point.position - place.position;
            const float height = dot(away, place.geometricNormal);
            const float distanceSquared = lengthSquared(away);
            if (height * height > kFlatness * kFlatness * distanceSquared + tolerance * tolerance)
                continue;
            if (count < kMostNear) near[count++] = {tile, cell, screen, distanceSquared};
        }
    }
    return count;
}

// What the points near a place tell of its clearance, once they are filled, and a ray straight up.
// Points in the open, beside a gap, see nothing of what makes it one.
float GatherPoints::clearanceAt(const Place& place, std::span<const Near> near) const {
    // What is near the place is at least as near as this, whichever point it was seen from.
    float clearance = std::numeric_limits<float>::max(), farthestSquared = 0.0f;
    for (const Near& point : near) {
        const Kept& kept = point.kept();
        if (!kept.ready.load(std::memory_order_acquire)) fill(*point.tile, point.cell);
        clearance = std::min(clearance, kept.clearance() + std::sqrt(point.distanceSquared));
        farthestSquared = std::max(farthestSquared, point.distanceSquared);
    }
    // What is so far up that the reach would still be twice the farthest point's makes no
    // difference.
    const float farthest = 2.0f * std::sqrt(farthestSquared) / reachOfClearance();
    const auto above =
        surroundingsOf(place).distanceAlong(place.geometricNormal, std::min(clearance, farthest));
    return std::min(clearance, above.value_or(clearance));
}

// Behind a wall that stands between: so thin that no point saw it, it is beyond their clearance.
// Where the point looks from is reached straight from it, so that a leaning wall is not passed on
// the way up.
bool GatherPoints::isHidden(const Place& place, const Near& point, float clearance) const {
    if (point.distanceSquared <= kSurelySeen * kSurelySeen * clearance * clearance) return false;
    const std::size_t at = point.cell.inTile();
    const float lift =
        std::min(kLift * std::sqrt(point.distanceSquared) + planeTolerance(place.position),
                 kLiftOfHeadroom * point.kept().headroom());
    const Vec3f apex =
        point.tile->points[at].position + point.tile->origins[at].geometricNormal * lift;
    return !isSeenFrom(m_scene, apex, place.position, place.geometricNormal);
}

bool GatherPoints::estimate(const Place& place, Estimate& result) const {
    std::array<Near, kMostNear> all;
    const auto near = std::span<const Near>(all).first(findNear(place, all));
    if (near.empty()) return false;
    result.clearance = clearanceAt(place, near);
    result.rays = 1;
    const float reach = reachOfClearance() * result.clearance;
    const float inverseReach = 1.0f / (reach * reach);
    float weights = 0, narrowWeights = 0, lamps = 0;
    TwoRadii sum;
    Rgb narrowSum;
    for (const Near& point : near) {
        // Epanechnikov's kernel over both distances.
        const float q = point.screenDistanceSquared + point.distanceSquared * inverseReach;
        if (!(q < 1.0f) || isHidden(place, point, result.clearance)) continue;
        const float weight = 1.0f - q, narrowWeight = std::max(0.0f, 1.0f - 2.0f * q);
        weights += weight;
        narrowWeights += narrowWeight;
        const Value value = point.kept().value();
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

std::uint64_t GatherPoints::memoryBytes() const {
    return m_mostTilesHeld * sizeof(Tile) + m_tiles.count() * sizeof(TileSlot);
}

std::uint64_t GatherPoints::memoryBytes(std::int32_t width, std::int32_t height, float spacing,
                                        const Rect& window) {
    const PointTiles tiles = tilesOf(width, height, spacing);
    return static_cast<std::uint64_t>(tiles.asked(window).area()) * sizeof(Tile) +
           tiles.count() * sizeof(TileSlot);
}

std::uint64_t GatherPoints::memoryBytes(std::int32_t width, std::int32_t height, float spacing,
                                        std::span<const Rect> regions, const Rect& all,
                                        std::size_t atOnce) {
    const PointTiles tiles = tilesOf(width, height, spacing);
    return tiles.mostAtOnce(regions, all, atOnce) * sizeof(Tile) + tiles.count() * sizeof(TileSlot);
}

}  // namespace pm
