// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/irradiance_sites.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

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
// Cells whose sites are not seen are halved so often at most.
constexpr int kMostHalvings = 3;
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
    const SurfaceEstimate estimate = estimateOf(cell.level);
    value.irradiance = estimate.at(value.position, value.normal, static_cast<std::uint32_t>(hash));
    value.height = apexHeight(m_estimate.scene(), value.position, value.normal, estimate.radius());
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
    std::array<float, 13> v;
    if (slot->ready.load(std::memory_order_acquire)) {
        for (std::size_t i = 0; i < v.size(); ++i)
            v[i] = slot->value[i].load(std::memory_order_relaxed);
        return {{v[0], v[1], v[2]},
                {v[3], v[4], v[5]},
                {{v[6], v[7], v[8]}, {v[9], v[10], v[11]}},
                v[12]};
    }
    const Value value = compute(cell, hash);
    const auto& [wide, narrow] = value.irradiance;
    v = {value.position.x, value.position.y, value.position.z, value.normal.x, value.normal.y,
         value.normal.z,   wide.r,           wide.g,           wide.b,         narrow.r,
         narrow.g,         narrow.b,         value.height};
    for (std::size_t i = 0; i < v.size(); ++i)
        slot->value[i].store(v[i], std::memory_order_relaxed);
    slot->ready.store(1, std::memory_order_release);
    return value;
}

// Whether the place is on the site's surface, and nothing stands between.
bool IrradianceSites::speaksFor(const Value& site, const Cell& cell, const Vec3f& position,
                                const Vec3f& normal) const {
    const Scene& scene = m_estimate.scene();
    const Vec3f way = position - site.position;
    if (scene.hasSheets() && m_estimate.gate(position, normal).isBesidePlane(way, site.normal))
        return false;
    const float height = dot(way, site.normal + normal);
    const float tolerance = 1e-4f * m_cells.sizeOf(cell);
    return dot(site.normal, normal) >= kSiteCosine &&
           height * height <=
               kSiteFlatness * kSiteFlatness * lengthSquared(way) + tolerance * tolerance &&
           isSeenFrom(scene, site.position + site.normal * site.height, position, normal);
}

// The cell beside, where the place is nearest to it.
IrradianceSites::Cell IrradianceSites::nearestAside(const Cell& cell, const Vec3f& position,
                                                    const Vec3f& normal) const {
    Cell aside = cell;
    const Vec3f place = (position - m_cells.origin()) * (1.0f / m_cells.sizeOf(cell));
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
    aside.place[static_cast<std::size_t>(nearest)] += step;
    return aside;
}

TwoRadii IrradianceSites::at(const Vec3f& position, const Vec3f& normal) const {
    const auto ask = [&](const Cell& cell) -> std::optional<TwoRadii> {
        const Value site = valueOf(cell);
        if (!speaksFor(site, cell, position, normal)) return std::nullopt;
        return site.irradiance;
    };
    const Cell cell = m_cells.at(position, normal);
    if (const auto found = ask(cell)) return *found;
    // A sliver of surface at an edge, or one of two surfaces in the cell.
    if (const auto found = ask(nearestAside(cell, position, normal))) return *found;
    for (int halvings = 1; halvings <= kMostHalvings; ++halvings)
        if (const auto found = ask(m_cells.at(position, normal, halvings))) return *found;
    return estimate(position, normal, patternAt(position));
}

std::uint64_t IrradianceSites::memoryBytes() const {
    return m_slotCount * sizeof(Slot);
}

std::uint64_t IrradianceSites::memoryBytes(std::uint64_t photons, float radiusFactor) {
    return slotsFor(photons, radiusFactor) * sizeof(Slot);
}

}  // namespace pm
