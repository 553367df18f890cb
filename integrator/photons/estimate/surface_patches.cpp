// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/estimate/surface_patches.h"

#include <tbb/concurrent_unordered_map.h>

#include <atomic>
#include <cmath>
#include <utility>

#include "integrator/photons/estimate/surface_cells.h"
#include "integrator/sampling/sampler.h"

namespace pm {

namespace {

// Of the step's radius. A patch reaches a radius beyond it, where its axes are the cell's and the
// site is in its middle.
constexpr float kCellSize = 2.0f * (SurfacePatch::kHalfWidth - 1.0f);
// Takes 1, and what rounding makes more of it, to a number below.
constexpr float kBelowOne = 0.999f;
// Where the corner of a cell lies, in cells: a scene's planes are seldom there.
constexpr Vec3f kOrigin{0.371f, 0.613f, 0.457f};
// What the table takes for an entry beside it, about.
constexpr std::uint64_t kEntryBytes = 48;

struct AsItIs {
    std::size_t operator()(std::uint64_t hash) const { return hash; }
};

}  // namespace

struct SurfacePatches::Table {
    tbb::concurrent_unordered_map<std::uint64_t, SurfacePatch, AsItIs> patches;
    std::atomic<std::uint64_t> bytes = 0;
    std::atomic<bool> isFull = false;
};

SurfacePatches::SurfacePatches(const Scene& scene, float unit, std::uint64_t mostBytes)
    : m_scene(scene), m_unit(unit), m_mostBytes(mostBytes), m_table(std::make_unique<Table>()) {}

SurfacePatches::~SurfacePatches() = default;

const SurfacePatch& SurfacePatches::at(const Vec3f& position, const Vec3f& normal, float radius,
                                       SurfacePatch& spare) const {
    // The power of two that makes radius / unit a number in (1/2, 1]: the first pass's radius,
    // which is the unit as a rule, is the largest of its step.
    int step = 0;
    std::frexp(radius / m_unit * kBelowOne, &step);
    const float largest = std::ldexp(m_unit, step);
    const float cellSize = kCellSize * largest;
    const SurfaceCells cells(m_scene, cellSize, kOrigin * cellSize);
    const SurfaceCells::Cell cell = cells.at(position, normal);
    const std::uint64_t key = combineBits(cell.hash(), static_cast<std::uint64_t>(step));
    if (const auto kept = m_table->patches.find(key); kept != m_table->patches.end())
        return kept->second;
    SurfacePatch patch;
    Vec3f site, siteNormal;
    if (cells.findSurface(cell, site, siteNormal))
        patch = SurfacePatch(m_scene, site, siteNormal, largest, key);
    const std::uint64_t bytes = patch.memoryBytes() + kEntryBytes;
    if (m_table->bytes.load(std::memory_order_relaxed) + bytes > m_mostBytes) {
        m_table->isFull.store(true, std::memory_order_relaxed);
        spare = std::move(patch);
        return spare;
    }
    // Two threads may both come here: they made the same patch, and one of them is kept.
    const auto [place, isNew] = m_table->patches.emplace(key, std::move(patch));
    if (isNew) m_table->bytes.fetch_add(bytes, std::memory_order_relaxed);
    return place->second;
}

void SurfacePatches::makeRoom() {
    if (m_table->isFull.load()) m_table = std::make_unique<Table>();
}

std::uint64_t SurfacePatches::memoryBytes() const {
    return m_table->bytes.load(std::memory_order_relaxed);
}

}  // namespace pm
