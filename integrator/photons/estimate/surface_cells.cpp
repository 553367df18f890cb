// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/estimate/surface_cells.h"

#include <cmath>

#include "integrator/sampling/sampler.h"
#include "integrator/sampling/warps.h"

namespace pm {

namespace {

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

// Without the libraries' floor, which costs a call.
std::int64_t floorToInteger(float x) {
    const auto whole = static_cast<std::int64_t>(x);
    return whole - (static_cast<float>(whole) > x ? 1 : 0);
}

}  // namespace

std::uint64_t SurfaceCells::Cell::hash() const {
    std::uint64_t h = 0;
    for (int axis = 0; axis < 3; ++axis)
        h = h * 0x9e3779b97f4a7c15ull +
            static_cast<std::uint64_t>(place[static_cast<std::size_t>(axis)] * 16 +
                                       direction[static_cast<std::size_t>(axis)] + 8);
    h = mixBits(h + static_cast<std::uint64_t>(level) * 0xd1b54a32d192ed03ull +
                static_cast<std::uint64_t>(halvings) * 0x8cb92ba72f3d8dd7ull);
    return h == 0 ? 1 : h;  // 0 is an empty slot
}

SurfaceCells::Cell SurfaceCells::at(const Vec3f& position, const Vec3f& normal,
                                    int halvings) const {
    const int level = m_focus.levelAt(position);
    const Vec3f place = (position - m_origin) * (1.0f / sizeOf(level, halvings));
    const Vec3f direction = normal * kDirectionSteps + Vec3f(0.5f);
    return {{floorToInteger(place.x), floorToInteger(place.y), floorToInteger(place.z)},
            {floorToInteger(direction.x), floorToInteger(direction.y), floorToInteger(direction.z)},
            level,
            halvings};
}

bool SurfaceCells::findAlong(const Vec3f& middle, const Vec3f& through, const Vec3f& direction,
                             float cellSize, Vec3f& position, Vec3f& normal) const {
    Ray ray{through + direction * cellSize, -direction, 2.0f * cellSize};
    for (int i = 0; i < kMostSurfaces; ++i) {
        Surface surface;
        if (!m_scene.meet(ray, surface)) return false;
        position = surface.position;
        normal = dot(surface.geometricNormal, direction) > 0.0f ? surface.geometricNormal
                                                                : -surface.geometricNormal;
        if (dot(normal, direction) >= kDirectionCosine &&
            maxAbsComponent(position - middle) <= kCellReach * cellSize &&
            m_scene.traits(surface.material).isDiffuse)
            return true;
        const float passed = dot(ray.origin - position, direction) + 1e-3f * cellSize;
        ray.origin -= direction * passed;
        ray.tMax -= passed;
        if (!(ray.tMax > 0.0f)) return false;
    }
    return false;
}

bool SurfaceCells::findSurface(const Cell& cell, Vec3f& position, Vec3f& normal) const {
    const float size = sizeOf(cell);
    const auto middleAlong = [&](std::size_t axis) {
        return (static_cast<float>(cell.place[axis]) + 0.5f) * size;
    };
    const Vec3f middle = m_origin + Vec3f{middleAlong(0), middleAlong(1), middleAlong(2)};
    const Vec3f direction = normalize(Vec3f{static_cast<float>(cell.direction[0]),
                                            static_cast<float>(cell.direction[1]),
                                            static_cast<float>(cell.direction[2])});
    if (findAlong(middle, middle, direction, size, position, normal)) return true;
    const Frame frame(direction);
    for (const float u : {-kAside, 0.0f, kAside})
        for (const float v : {-kAside, 0.0f, kAside}) {
            if (u == 0.0f && v == 0.0f) continue;
            const Vec3f aside = (frame.tangent * u + frame.bitangent * v) * size;
            if (findAlong(middle, middle + aside, direction, size, position, normal)) return true;
        }
    return false;
}

}  // namespace pm
