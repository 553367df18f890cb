// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "integrator/photons/estimate/caustic_map.h"
#include "integrator/photons/estimate/irradiance_sites.h"
#include "integrator/photons/estimate/surface_estimate.h"
#include "integrator/sampling/sampler.h"
#include "integrator/scene/camera.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/gather/gather_guide.h"
#include "integrator/transport/gather/point_tiles.h"
#include "integrator/transport/gather/virtual_lamps.h"

namespace pm {

class LightSampler;
class Surroundings;

// Indirect irradiance, as final gathering finds it, kept at points that the camera sees: one in
// each cell of a lattice over the frame, anew in each pass. A camera sample takes the weighted mean
// of the points near it, on its surface and on the screen, so that a few gather rays serve many
// samples. It is a density estimate of what the gather rays bring: its radius shrinks from pass to
// pass, and what it blurs vanishes with it.
//
// Where other surfaces are near, irradiance changes within their distance; there the radius is a
// share of the smallest distance at which the gather rays meet one.
// Source of the idea: Ward, Rubinstein & Clear 1988, "A Ray Tracing Solution for Diffuse
// Interreflection", with the harmonic mean of the distances; that misses what few rays meet.
//
// Points are made a tile at a time, when a sample first asks for one of it; a point's irradiance is
// computed when it is first asked for. Neither depends on who asks. A tile is forgotten when all
// pixels whose samples could ask are done.
// Threads: const functions from any, at once.
class GatherPoints {
  public:
    struct Request {
        std::int32_t width = 0, height = 0;  // pixels of the frame
        float spacing = 2.5f;                // of the lattice, pixels
        std::uint32_t rays = 24;             // gather rays of each point, >= 1
        float radiusFactor = 1.0f;           // this pass's radii over the first pass's
        std::uint64_t seed = 1;
        std::uint32_t pass = 0;
        // Caustics, whose light goes to the points straight; may be null.
        const VirtualLamps* caustics = nullptr;
        // Light that they send by way of other lobes, estimated at each point; may be null.
        const SurfaceEstimate* refocused = nullptr;
        // Its radii in the first pass, from place to place; null where `refocused` is.
        const PilotRadius* refocusedRadius = nullptr;
        // Where the rays go by; null: by the cosine alone.
        const GatherGuide* guide = nullptr;
        // As of GatherEnds.
        const LightSampler* lights = nullptr;
    };
    static constexpr std::uint32_t kEven = 0xffffffffu;
    // Of surfaces that what is kept for one speaks for, as far as their directions go.
    static std::uint32_t admitsOf(const Admission& admission, std::uint32_t material) {
        if (admission.isEven()) return kEven;
        return static_cast<std::uint32_t>(
            mixBits(std::uint64_t{material} << 32 | admission.kind()) >> 33);
    }
    // A place that a camera path came to.
    struct Place {
        Vec2f screen;  // where the path left the camera, pixels
        Vec3f position;
        Vec3f shadingNormal, geometricNormal;  // unit, on the side that the path came to
        float offset = 0.0f;  // along the geometric one, to where rays leave from; scene units
        // See admitsOf().
        std::uint32_t admits = kEven;
    };
    struct Estimate {
        TwoRadii irradiance;     // W m^-2
        float lampShare = 0.0f;  // of the gather rays that met a lamp's front
        std::uint32_t rays = 0;  // that this took
        // Of the place, as the points near tell, in reach or not; infinity where there is none.
        // Scene units.
        float clearance = std::numeric_limits<float>::infinity();
    };

    // scene, camera and sites must outlive this.
    GatherPoints(const Scene& scene, const Camera& camera, const IrradianceSites& sites,
                 const Request& request);
    ~GatherPoints();
    GatherPoints(const GatherPoints&) = delete;
    GatherPoints& operator=(const GatherPoints&) = delete;

    // Indirect irradiance at a place. False where no point is near enough.
    bool estimate(const Place& place, Estimate& result) const;

    // Irradiance of refocused light at a place itself, for samples without a point in reach; 0
    // where there is none. clearance: as `estimate` found it. pattern: any number that depends on
    // the place alone.
    TwoRadii refocusedAt(const Place& place, float clearance, std::uint32_t pattern) const;

    // No samples of the pixels of `region` will come any more; regions divide `all`, which is all
    // that is rendered. A sample that comes all the same, or beyond `all`, may find memory given
    // back while it reads: don't.
    void forget(const Rect& region, const Rect& all) const;

    std::uint32_t raysOfPoint() const { return m_request.rays; }
    // By which gather rays leave a place; none: by the cosine alone.
    std::optional<GatherGuide::Directions> directionsAt(const Vec3f& position,
                                                        const Frame& frame) const {
        if (!m_request.guide) return std::nullopt;
        return m_request.guide->at(position, frame);
    }
    // Gather rays so far.
    std::uint64_t raysTraced() const { return m_raysTraced.load(std::memory_order_relaxed); }
    // The most that the points took so far.
    std::uint64_t memoryBytes() const;
    // Of the points that pixels of a window ask for, for memory plans.
    static std::uint64_t memoryBytes(std::int32_t width, std::int32_t height, float spacing,
                                     const Rect& window);
    // The most where pixels are done and forgotten region by region, as PointTiles::mostAtOnce.
    static std::uint64_t memoryBytes(std::int32_t width, std::int32_t height, float spacing,
                                     std::span<const Rect> regions, const Rect& all,
                                     std::size_t atOnce);

  private:
    struct Point {
        Vec3f position;
        Vec3f normal;          // shading, on the camera's side; 0 where there is no point
        Vec2f screen;          // pixels
        std::uint32_t admits;  // as of Place
    };
    // Where the gather rays leave from.
    struct Origin {
        Vec3f geometricNormal;  // on the camera's side
        float offset;
        float width;  // of what the camera's ray covers there
        Admission admission;
    };
    // What the gather rays of a point found.
    struct Value {
        TwoRadii irradiance;
        float lampShare = 0.0f;
        float clearance = 0.0f;  // smallest distance met, scene units
        float headroom = 0.0f;   // straight up to what is met, scene units
    };
    // A Value that is computed when it is first asked for.
    struct Kept {
        std::array<std::atomic<float>, 9> numbers;
        std::atomic<std::uint32_t> ready{0};

        float number(std::size_t i) const { return numbers[i].load(std::memory_order_relaxed); }
        float clearance() const { return number(7); }
        float headroom() const { return number(8); }
        Value value() const {
            return {{{number(0), number(1), number(2)}, {number(3), number(4), number(5)}},
                    number(6),
                    clearance(),
                    headroom()};
        }
    };
    struct Tile {
        std::array<Point, PointTiles::kCells> points;
        std::array<Origin, PointTiles::kCells> origins;
        std::array<Kept, PointTiles::kCells> kept;
    };
    // Of the lattice.
    struct Cell {
        std::size_t column, row;
        std::size_t inTile() const {
            return row % PointTiles::kSide * PointTiles::kSide + column % PointTiles::kSide;
        }
    };
    struct TileSlot {
        std::atomic<Tile*> tile{nullptr};  // null until it is asked for, and once it is forgotten
        std::atomic<std::int64_t> donePixels{0};
    };
    // A point that may count, and how far away it is.
    struct Near {
        Tile* tile;
        Cell cell;
        float screenDistanceSquared;  // over the radius squared
        float distanceSquared;        // scene units squared
        const Kept& kept() const { return tile->kept[cell.inTile()]; }
    };
    static constexpr std::size_t kMostNear = 64;

    void tracePoint(Tile& tile, const Cell& cell) const;
    Tile* tileAt(std::size_t slot) const;
    std::size_t findNear(const Place& place, std::array<Near, kMostNear>& near) const;
    void fill(Tile& tile, const Cell& cell) const;
    float reachOfClearance() const;
    float clearanceAt(const Place& place, std::span<const Near> near) const;
    bool isHidden(const Place& place, const Near& point, float clearance) const;
    Surroundings surroundingsOf(const Place& place) const;
    float refocusedRadius(const Vec3f& position, const Vec3f& normal) const;
    TwoRadii refocused(const Vec3f& position, const Vec3f& normal, float clearance, float radius,
                       std::uint32_t pattern) const;
    Value gather(const Point& point, const Origin& origin, const Sampler& shared, std::size_t part,
                 std::uint64_t& rays) const;
    std::size_t sequenceOf(const Cell& cell) const;
    Rgb sampleCaustics(const Point& point, const Origin& origin, const Cell& cell) const;
    Value compute(const Tile& tile, const Cell& cell, std::uint64_t& rays) const;
    // What rounding may lift a point off its plane, scene units.
    float planeTolerance(const Vec3f& position) const;

    const Scene& m_scene;
    const Camera& m_camera;
    const IrradianceSites& m_sites;
    Request m_request;
    float m_radius;  // of the mean, pixels
    PointTiles m_tiles;
    std::unique_ptr<TileSlot[]> m_slots;
    // Written with every point: not in a cache line with what every look-up reads.
    static constexpr std::size_t kCacheLine = 64;
    alignas(kCacheLine) mutable std::atomic<std::size_t> m_tilesHeld{0};
    mutable std::atomic<std::size_t> m_mostTilesHeld{0};
    mutable std::atomic<std::uint64_t> m_raysTraced{0};
};

}  // namespace pm
