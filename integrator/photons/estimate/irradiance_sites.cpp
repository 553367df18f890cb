// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/estimate/irradiance_sites.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

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
// Of the map, filled by one thread: some pages.
constexpr std::uint32_t kPhotonsAtOnce = 1 << 14;
constexpr std::size_t kFewestSlots = 1 << 16, kMostSlots = 1 << 22, kMostProbes = 16;
// Slots of a photon in the first pass: of evenly lit rooms a quarter to a third was in use there,
// and as radii shrink, sites grow in number. Later passes have up to three times as many.
constexpr double kSlotsPerPhoton = 0.5, kMostSlotsPerPhoton = 1.5;

std::size_t slotsFor(std::size_t photons, float radiusFactor, float room) {
    const auto factor = static_cast<double>(radiusFactor);
    const double each = std::min(kSlotsPerPhoton / (factor * factor), kMostSlotsPerPhoton);
    const std::size_t usual = std::clamp(
        static_cast<std::size_t>(each * static_cast<double>(photons)), kFewestSlots, kMostSlots);
    return std::max(kFewestSlots, static_cast<std::size_t>(static_cast<double>(room) *
                                                           static_cast<double>(usual)));
}

template <std::size_t N>
std::array<float, N> load(const std::array<std::atomic<float>, N>& from) {
    std::array<float, N> values;
    for (std::size_t i = 0; i < N; ++i) values[i] = from[i].load(std::memory_order_relaxed);
    return values;
}

template <std::size_t N>
void store(const std::array<float, N>& values, std::array<std::atomic<float>, N>& to) {
    for (std::size_t i = 0; i < N; ++i) to[i].store(values[i], std::memory_order_relaxed);
}

// Of the cells.
Vec3f originOf(float radius, std::uint64_t key) {
    Vec3f origin;
    std::uint64_t random = mixBits(key);
    for (int axis = 0; axis < 3; ++axis) {
        random = mixBits(random + 1);
        origin[axis] = kCellSize * radius * toUnitFloat(static_cast<std::uint32_t>(random));
    }
    return origin;
}

}  // namespace

IrradianceSites::IrradianceSites(const Scene& scene, const PhotonMap& map, float radius,
                                 const SurfacePatches* patches, float radiusFactor,
                                 const Focus& focus, float room, std::uint64_t key)
    : m_estimate(scene, map, radius, patches),
      m_cells(scene, kCellSize * radius, originOf(radius, key), focus),
      m_slotCount(slotsFor(map.size(), radiusFactor, room)),
      m_slots(makeBigZeroedArray<Slot>(m_slotCount)) {}

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

IrradianceSites::Place IrradianceSites::placeOf(const Cell& cell, Slot* slot) const {
    if (slot && slot->known.load(std::memory_order_acquire) != kNothing) {
        const std::array<float, 6> p = load(slot->place);
        return {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}};
    }
    Place site;
    if (!m_cells.findSurface(cell, site.position, site.normal)) site = {};
    if (!slot) return site;
    store<6>({site.position.x, site.position.y, site.position.z, site.normal.x, site.normal.y,
              site.normal.z},
             slot->place);
    // Another thread may know all by now.
    std::uint32_t known = kNothing;
    slot->known.compare_exchange_strong(known, kPlace, std::memory_order_release,
                                        std::memory_order_relaxed);
    return site;
}

IrradianceSites::Value IrradianceSites::valueOf(const Cell& cell, std::uint64_t hash,
                                                const Place& site, Slot* slot) const {
    if (slot && slot->known.load(std::memory_order_acquire) == kAll) {
        const std::array<float, 7> v = load(slot->value);
        return {{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}}, v[6]};
    }
    const SurfaceEstimate estimate = estimateOf(cell.level);
    const Value value{
        estimate.at(site.position, site.normal, static_cast<std::uint32_t>(hash)),
        apexHeight(m_estimate.scene(), site.position, site.normal, estimate.radius())};
    if (!slot) return value;
    const auto& [wide, narrow] = value.irradiance;
    store<7>({wide.r, wide.g, wide.b, narrow.r, narrow.g, narrow.b, value.height}, slot->value);
    slot->known.store(kAll, std::memory_order_release);
    return value;
}

// Whether the place is on the site's surface, though something may stand between.
bool IrradianceSites::isBeside(const Place& site, const Cell& cell, const Vec3f& position,
                               const Vec3f& normal) const {
    const Vec3f way = position - site.position;
    if (m_estimate.scene().hasSheets() &&
        m_estimate.gate(position, normal).isBesidePlane(way, site.normal))
        return false;
    const float height = dot(way, site.normal + normal);
    const float tolerance = 1e-4f * m_cells.sizeOf(cell);
    return dot(site.normal, normal) >= kSiteCosine &&
           height * height <=
               kSiteFlatness * kSiteFlatness * lengthSquared(way) + tolerance * tolerance;
}

// Nothing where the cell's site doesn't speak for the place.
std::optional<TwoRadii> IrradianceSites::ask(const Cell& cell, const Vec3f& position,
                                             const Vec3f& normal) const {
    const std::uint64_t hash = cell.hash();
    Slot* const slot = slotOf(hash);
    const Place site = placeOf(cell, slot);
    if (!isBeside(site, cell, position, normal)) return std::nullopt;
    const Value value = valueOf(cell, hash, site, slot);
    const Vec3f apex = site.position + site.normal * value.height;
    if (!isSeenFrom(m_estimate.scene(), apex, position, normal)) return std::nullopt;
    return value.irradiance;
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
    const Cell cell = m_cells.at(position, normal);
    if (const auto found = ask(cell, position, normal)) return *found;
    // A sliver of surface at an edge, or one of two surfaces in the cell.
    const Cell aside = nearestAside(cell, position, normal);
    if (const auto found = ask(aside, position, normal)) return *found;
    for (int halvings = 1; halvings <= kMostHalvings; ++halvings)
        if (const auto found = ask(m_cells.at(position, normal, halvings), position, normal))
            return *found;
    return estimate(position, normal, patternAt(position, m_estimate.radius()));
}

void IrradianceSites::fill(const CancelCheck& cancel) const {
    const PhotonMap& map = m_estimate.map();
    const auto fillSome = [&](const tbb::blocked_range<std::uint32_t>& some) {
        cancel.throwIfSet("estimating irradiance");
        const CacheWatch::As as(CacheUser::kPhoton);
        std::uint64_t last = 0;
        for (std::uint32_t i = some.begin(); i < some.end(); ++i) {
            const Photon photon = map.photon(i);
            const Vec3f normal = photon.normal.unpack();
            const Cell cell = m_cells.at(photon.position, normal);
            const std::uint64_t hash = cell.hash();
            if (std::exchange(last, hash) == hash) continue;
            Slot* const slot = slotOf(hash);
            if (!slot) continue;
            const Place site = placeOf(cell, slot);
            if (isBeside(site, cell, photon.position, normal)) valueOf(cell, hash, site, slot);
        }
    };
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(map.size()),
                                                        kPhotonsAtOnce),
                      fillSome);
}

std::uint64_t IrradianceSites::memoryBytes() const {
    return m_slotCount * sizeof(Slot);
}

std::uint64_t IrradianceSites::memoryBytes(std::uint64_t photons, float radiusFactor, float room) {
    return slotsFor(photons, radiusFactor, room) * sizeof(Slot);
}

}  // namespace pm
