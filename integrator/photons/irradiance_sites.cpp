// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/irradiance_sites.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <new>

#include "integrator/sampling/sampler.h"
#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// Of the radius: some nine sites share a disc.
constexpr float kCellSize = 0.6f;
// Steps of a normal's components that make a rough direction, about 20 degrees wide.
constexpr float kDirectionSteps = 3.0f;
// Surfaces within this of the rough direction belong to it; a bin's corner is 25 degrees away.
constexpr float kDirectionCosine = 0.85f;
// Where a cell's surface is looked for from its middle, in its size: the middle, then around it, so
// that no more than a sliver at an edge is missed.
constexpr float kAside = 0.42f;
// A surface found farther than this from the middle along an axis belongs to another cell.
constexpr float kCellReach = 0.6f;
// Surfaces that a ray passes on its way to the right one.
constexpr int kMostSurfaces = 4;
// Between a point and its site the surface bends by at most 37 degrees, ...
constexpr float kSiteCosine = 0.8f;
// ... and evenly: then the way is at right angles to the sum of both normals, within this.
constexpr float kSiteFlatness = 0.2f;
constexpr std::size_t kFewestSlots = 1 << 16, kMostSlots = 1 << 22, kMostProbes = 16;

// Without the libraries' floor, which costs a call.
std::int64_t floorToInteger(float x) {
    const auto whole = static_cast<std::int64_t>(x);
    return whole - (static_cast<float>(whole) > x ? 1 : 0);
}

}  // namespace

IrradianceSites::IrradianceSites(const Scene& scene, const PhotonMap& map, float radius)
    : m_scene(scene),
      m_estimate(scene, map, radius),
      m_cellSize(kCellSize * radius),
      m_slotCount(std::bit_ceil(std::clamp(map.size(), kFewestSlots, kMostSlots))),
      m_slots(static_cast<Slot*>(std::calloc(m_slotCount, sizeof(Slot)))) {
    if (!m_slots) throw std::bad_alloc();
    // Radii differ from pass to pass.
    std::uint64_t random = mixBits(std::bit_cast<std::uint32_t>(radius) + map.size());
    for (int axis = 0; axis < 3; ++axis) {
        random = mixBits(random + 1);
        m_origin[axis] = m_cellSize * toUnitFloat(static_cast<std::uint32_t>(random));
    }
}

std::uint64_t IrradianceSites::Cell::hash() const {
    std::uint64_t h = 0;
    for (int axis = 0; axis < 3; ++axis)
        h = h * 0x9e3779b97f4a7c15ull +
            static_cast<std::uint64_t>(place[static_cast<std::size_t>(axis)] * 16 +
                                       direction[static_cast<std::size_t>(axis)] + 8);
    h = mixBits(h);
    return h == 0 ? 1 : h;  // 0 is an empty slot
}

IrradianceSites::Cell IrradianceSites::cellAt(const Vec3f& position, const Vec3f& normal) const {
    const Vec3f place = (position - m_origin) * (1.0f / m_cellSize);
    const Vec3f direction = normal * kDirectionSteps + Vec3f(0.5f);
    return {
        {floorToInteger(place.x), floorToInteger(place.y), floorToInteger(place.z)},
        {floorToInteger(direction.x), floorToInteger(direction.y), floorToInteger(direction.z)}};
}

bool IrradianceSites::findAlong(const Vec3f& middle, const Vec3f& through, const Vec3f& direction,
                                Vec3f& position, Vec3f& normal) const {
    Ray ray{through + direction * m_cellSize, -direction, 2.0f * m_cellSize};
    for (int i = 0; i < kMostSurfaces; ++i) {
        Surface surface;
        if (!m_scene.intersect(ray, surface)) return false;
        position = surface.position;
        normal = dot(surface.geometricNormal, direction) > 0.0f ? surface.geometricNormal
                                                                : -surface.geometricNormal;
        const MaterialDescription& material = m_scene.material(surface.material);
        if (dot(normal, direction) >= kDirectionCosine &&
            maxAbsComponent(position - middle) <= kCellReach * m_cellSize &&
            material.kind == MaterialKind::kSurface && !isBlack(material.diffuse))
            return true;
        const float passed = dot(ray.origin - position, direction) + 1e-3f * m_cellSize;
        ray.origin -= direction * passed;
        ray.tMax -= passed;
        if (!(ray.tMax > 0.0f)) return false;
    }
    return false;
}

bool IrradianceSites::findSurface(const Cell& cell, Vec3f& position, Vec3f& normal) const {
    const auto middleAlong = [&](std::size_t axis) {
        return (static_cast<float>(cell.place[axis]) + 0.5f) * m_cellSize;
    };
    const Vec3f middle = m_origin + Vec3f{middleAlong(0), middleAlong(1), middleAlong(2)};
    const Vec3f direction = normalize(Vec3f{static_cast<float>(cell.direction[0]),
                                            static_cast<float>(cell.direction[1]),
                                            static_cast<float>(cell.direction[2])});
    if (findAlong(middle, middle, direction, position, normal)) return true;
    const Frame frame(direction);
    for (const float u : {-kAside, 0.0f, kAside})
        for (const float v : {-kAside, 0.0f, kAside}) {
            if (u == 0.0f && v == 0.0f) continue;
            const Vec3f aside = (frame.tangent * u + frame.bitangent * v) * m_cellSize;
            if (findAlong(middle, middle + aside, direction, position, normal)) return true;
        }
    return false;
}

IrradianceSites::Value IrradianceSites::compute(const Cell& cell, std::uint64_t hash) const {
    Value value;
    if (!findSurface(cell, value.position, value.normal)) return {};
    value.irradiance =
        m_estimate.at(value.position, value.normal, static_cast<std::uint32_t>(hash));
    return value;
}

// Null where too many others are in the way.
IrradianceSites::Slot* IrradianceSites::slotOf(std::uint64_t hash) const {
    for (std::size_t i = 0; i < kMostProbes; ++i) {
        Slot& slot = m_slots[(hash + i) & (m_slotCount - 1)];
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
    const auto speaksFor = [&](const Value& site) {
        const Vec3f way = position - site.position;
        const float height = dot(way, site.normal + normal);
        const float tolerance = 1e-4f * m_cellSize;
        return dot(site.normal, normal) >= kSiteCosine &&
               height * height <=
                   kSiteFlatness * kSiteFlatness * lengthSquared(way) + tolerance * tolerance;
    };
    Cell cell = cellAt(position, normal);
    Value site = valueOf(cell);
    if (speaksFor(site)) return site.irradiance;
    // A sliver of surface at an edge, or one of two surfaces in the cell: the nearest cell aside.
    const Vec3f place = (position - m_origin) * (1.0f / m_cellSize);
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
    // Any pattern that depends on the point alone.
    const auto pattern = std::bit_cast<std::uint32_t>(position.x) ^
                         std::bit_cast<std::uint32_t>(position.y + position.z);
    return estimate(position, normal, pattern);
}

std::uint64_t IrradianceSites::memoryBytes() const {
    return m_slotCount * sizeof(Slot);
}

}  // namespace pm
