// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/irradiance_sites.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "integrator/sampling/sampler.h"
#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// Of the radius: some nine sites share a disc.
constexpr float kCellSize = 0.6f;
// Between a point and its site the surface bends by at most 37 degrees, ...
constexpr float kSiteCosine = 0.8f;
// ... and evenly: then the way is at right angles to the sum of both normals, within this.
constexpr float kSiteFlatness = 0.2f;
constexpr std::size_t kFewestSlots = 1 << 16, kMostSlots = 1 << 22, kMostProbes = 16;
// Slots of a photon in the first pass: of evenly lit rooms a quarter to a third was in use there,
// and as radii shrink, sites grow in number. Later passes have up to three times as many.
constexpr double kSlotsPerPhoton = 0.5, kMostSlotsPerPhoton = 1.5;

std::size_t slotsFor(std::size_t photons, float radiusFactor) {
    const auto factor = static_cast<double>(radiusFactor);
    const double each = std::min(kSlotsPerPhoton / (factor * factor), kMostSlotsPerPhoton);
    return std::clamp(static_cast<std::size_t>(each * static_cast<double>(photons)), kFewestSlots,
                      kMostSlots);
}

// Of the cells: another one in each pass, as radii differ from pass to pass.
Vec3f originOf(const PhotonMap& map, float radius) {
    Vec3f origin;
    std::uint64_t random = mixBits(std::bit_cast<std::uint32_t>(radius) + map.size());
    for (int axis = 0; axis < 3; ++axis) {
        random = mixBits(random + 1);
        origin[axis] = kCellSize * radius * toUnitFloat(static_cast<std::uint32_t>(random));
    }
    return origin;
}

}  // namespace

IrradianceSites::IrradianceSites(const Scene& scene, const PhotonMap& map, float radius,
                                 const SurfacePatches* patches, float radiusFactor,
                                 const Focus& focus)
    : m_estimate(scene, map, radius, patches),
      m_cells(scene, kCellSize * radius, originOf(map, radius), focus),
      m_slotCount(slotsFor(map.size(), radiusFactor)),
      m_slots(makeBigZeroedArray<Slot>(m_slotCount)) {}

IrradianceSites::Value IrradianceSites::compute(const Cell& cell, std::uint64_t hash) const {
    Value value;
    if (!m_cells.findSurface(cell, value.position, value.normal)) return {};
    value.irradiance =
        estimateOf(cell.level).at(value.position, value.normal, static_cast<std::uint32_t>(hash));
    return value;
}

// Null where too many others are in the way.
IrradianceSites::Slot* IrradianceSites::slotOf(std::uint64_t hash) const {
    const std::size_t first = firstSlot(hash);
    for (std::size_t i = 0; i < kMostProbes; ++i) {
        const std::size_t at = first + i < m_slotCount ? first + i : first + i - m_slotCount;
        Slot& slot = m_slots[at];
        std::uint64_t cell = slot.cell.load(std::memory_order_relaxed);
        if (cell == hash) return &slot;
        if (cell == 0 && slot.cell.compare_exchange_strong(cell, hash, std::memory_order_relaxed))
            return &slot;
        if (cell == hash) return &slot;  // another thread was faster
    }
    return nullptr;
}

IrradianceSites::Value IrradianceSites::valueOf(const Cell& cell) const {
    const std::uint64_t hash = cell.hash();
    Slot* const slot = slotOf(hash);
    if (!slot) return compute(cell, hash);
    std::array<float, 12> v;
    if (slot->ready.load(std::memory_order_acquire)) {
        for (std::size_t i = 0; i < v.size(); ++i)
            v[i] = slot->value[i].load(std::memory_order_relaxed);
        return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {{v[6], v[7], v[8]}, {v[9], v[10], v[11]}}};
    }
    const Value value = compute(cell, hash);
    v = {value.position.x,
         value.position.y,
         value.position.z,
         value.normal.x,
         value.normal.y,
         value.normal.z,
         value.irradiance.wide.r,
         value.irradiance.wide.g,
         value.irradiance.wide.b,
         value.irradiance.narrow.r,
         value.irradiance.narrow.g,
         value.irradiance.narrow.b};
    for (std::size_t i = 0; i < v.size(); ++i)
        slot->value[i].store(v[i], std::memory_order_relaxed);
    slot->ready.store(1, std::memory_order_release);
    return value;
}

TwoRadii IrradianceSites::at(const Vec3f& position, const Vec3f& normal) const {
    Cell cell = m_cells.at(position, normal);
    const float cellSize = m_cells.cellSize(cell.level);
    const auto speaksFor = [&](const Value& site) {
        const Vec3f way = position - site.position;
        if (m_estimate.scene().hasSheets() &&
            m_estimate.gate(position, normal).isBesidePlane(way, site.normal))
            return false;
        const float height = dot(way, site.normal + normal);
        const float tolerance = 1e-4f * cellSize;
        return dot(site.normal, normal) >= kSiteCosine &&
               height * height <=
                   kSiteFlatness * kSiteFlatness * lengthSquared(way) + tolerance * tolerance;
    };
    Value site = valueOf(cell);
    if (speaksFor(site)) return site.irradiance;
    // A sliver of surface at an edge, or one of two surfaces in the cell: the nearest cell aside.
    const Vec3f place = (position - m_cells.origin()) * (1.0f / cellSize);
    int nearest = 0;
    float way = 1.0f;
    std::int64_t step = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const float inside =
            place[axis] - static_cast<float>(cell.place[static_cast<std::size_t>(axis)]);
        const float toSide = std::min(inside, 1.0f - inside);
        if (toSide >= way || std::abs(normal[axis]) > 0.7f) continue;
        nearest = axis;
        way = toSide;
        step = inside < 0.5f ? -1 : 1;
    }
    cell.place[static_cast<std::size_t>(nearest)] += step;
    site = valueOf(cell);
    if (speaksFor(site)) return site.irradiance;
    return estimate(position, normal, patternAt(position));
}

std::uint64_t IrradianceSites::memoryBytes() const {
    return m_slotCount * sizeof(Slot);
}

std::uint64_t IrradianceSites::memoryBytes(std::uint64_t photons, float radiusFactor) {
    return slotsFor(photons, radiusFactor) * sizeof(Slot);
}

}  // namespace pm
