// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/look/occupancy_grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace pm::host {
namespace {

using Point = std::array<double, 3>;

// Samples of large faces, all together; a tenth of a second.
constexpr std::int64_t kBudget = 8'000'000;
constexpr int kSamplesPerCell = 2;  // along an edge: no hole between them is as wide as a cell

Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double longestSide(const Point& a, const Point& b, const Point& c) {
    double most = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto [low, high] = std::minmax({a[axis], b[axis], c[axis]});
        most = std::max(most, high - low);
    }
    return most;
}

// A sphere as quads, about its centre: enough for a grid of cells.
MeshData facesOf(const SphereData& sphere) {
    constexpr std::uint32_t kAround = 16, kRows = 8;
    MeshData ball;
    for (std::uint32_t row = 0; row <= kRows; ++row) {
        const double polar = std::numbers::pi * row / kRows;
        for (std::uint32_t i = 0; i < kAround; ++i) {
            const double around = 2 * std::numbers::pi * i / kAround;
            for (const double part : {std::sin(polar) * std::sin(around), std::cos(polar),
                                      std::sin(polar) * std::cos(around)})
                ball.positions.push_back(static_cast<float>(sphere.radius * part));
            if (row == kRows) continue;
            const std::uint32_t here = row * kAround, next = (i + 1) % kAround;
            ball.faceSizes.push_back(4);
            ball.faceSlots.push_back(0);
            for (const std::uint32_t corner :
                 {here + i, here + kAround + i, here + kAround + next, here + next})
                ball.indices.push_back(corner);
        }
    }
    return ball;
}

bool letsLightThrough(const MaterialData& material) {
    return material.kind == MaterialKind::kDielectric || material.transparency > 0 ||
           material.opacityTexture.has_value();
}

}  // namespace

struct OccupancyGrid::Splat {
    Point corner, u, v;  // the corner and the edges from it
    Point normal;        // of length twice the area
    double longest;
    bool emits;
    bool isClear;  // light passes it
};

Point asIfYWereUp(const Point& place) {
    return {place[0], place[2], -place[1]};
}

Point backToZUp(const Point& place) {
    return {place[0], -place[2], place[1]};
}

Bounds asIfYWereUp(const Bounds& bounds) {
    Bounds turned{asIfYWereUp(bounds.low), asIfYWereUp(bounds.high)};
    std::swap(turned.low[2], turned.high[2]);
    return turned;
}

OccupancyGrid::OccupancyGrid(const SceneData& scene, bool upIsZ) : m_upIsZ(upIsZ) {
    const Bounds bounds = upIsZ ? asIfYWereUp(scene.bounds) : scene.bounds;
    double longest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        longest = std::max(longest, bounds.high[axis] - bounds.low[axis]);
    if (longest > 0 && std::isfinite(longest)) {
        m_cellSize = longest / kCells;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double width = bounds.high[axis] - bounds.low[axis];
            const int inner =
                std::clamp(static_cast<int>(std::ceil(width / m_cellSize - 1e-6)), 1, kCells);
            m_size[axis] = inner + 2 * kMargin;
            // Centred: what lies on the bounds then lies in a cell of theirs, on both sides.
            m_origin[axis] = bounds.low[axis] + width / 2 - m_cellSize * m_size[axis] / 2;
        }
    }
    const std::size_t cells = static_cast<std::size_t>(m_size[0]) *
                              static_cast<std::size_t>(m_size[1]) *
                              static_cast<std::size_t>(m_size[2]);
    m_holds.resize(cells);
    m_areas.resize(cells);
    std::int64_t budget = kBudget;
    if (m_cellSize > 0)
        for (const InstanceData& instance : scene.instances) add(instance, scene, budget);
}

bool OccupancyGrid::contains(const Cell& cell) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (cell[axis] < 0 || cell[axis] >= m_size[axis]) return false;
    return true;
}

Cell OccupancyGrid::cellOf(const Point& place) const {
    Cell cell{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        cell[axis] = static_cast<int>(std::clamp(
            std::floor((place[axis] - m_origin[axis]) / m_cellSize), -1.0, 1.0 + m_size[axis]));
    return cell;
}

Point OccupancyGrid::middleOf(const Cell& cell) const {
    Point middle{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        middle[axis] = m_origin[axis] + m_cellSize * (cell[axis] + 0.5);
    return middle;
}

void OccupancyGrid::add(const InstanceData& instance, const SceneData& scene,
                        std::int64_t& budget) {
    const bool isMesh = instance.shape == InstanceData::Shape::kMesh;
    const MeshData ball = isMesh ? MeshData{} : facesOf(scene.spheres[instance.index]);
    const MeshData& mesh = isMesh ? scene.meshes[instance.index] : ball;
    const Point& origin = isMesh ? scene.centre : scene.spheres[instance.index].centre;
    const std::vector<std::uint32_t>& materials = scene.materialsOf(instance);
    const auto place = [&](std::size_t corner) {
        Point world = mesh.position(mesh.indices[corner]);
        for (std::size_t axis = 0; axis < 3; ++axis) world[axis] += origin[axis];
        if (instance.transform) world = transformed(*instance.transform, world);
        return m_upIsZ ? asIfYWereUp(world) : world;
    };
    std::size_t first = 0;
    for (std::size_t face = 0; face < mesh.faceSizes.size(); ++face) {
        const MaterialData& material = scene.materials[materials[mesh.faceSlots[face]]];
        const std::size_t size = mesh.faceSizes[face];
        const bool isClear = letsLightThrough(material);
        const Point a = place(first);
        Point b = place(first + 1);
        for (std::size_t i = 2; i < size; ++i) {
            const Point c = place(first + i);
            Splat triangle{a, {}, {}, {}, longestSide(a, b, c), material.emits(), isClear};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                triangle.u[axis] = b[axis] - a[axis];
                triangle.v[axis] = c[axis] - a[axis];
            }
            triangle.normal = cross(triangle.u, triangle.v);
            splat(triangle, budget);
            b = c;
        }
        first += size;
    }
}

// At points of a regular net on the triangle.
void OccupancyGrid::splat(const Splat& triangle, std::int64_t& budget) {
    auto steps =
        static_cast<std::int64_t>(std::ceil(triangle.longest / m_cellSize * kSamplesPerCell));
    steps = std::clamp<std::int64_t>(steps, 1, kCells * kSamplesPerCell);
    if (steps > 1) budget -= steps * steps;
    if (budget < 0) steps = 1;
    const double share = 1.0 / static_cast<double>(steps * steps);
    std::array<float, kSides> areas{};
    for (std::size_t side = 0; side < kSides; ++side) {
        const double towards = triangle.normal[side / 2] * (side % 2 == 0 ? -1 : 1);
        areas[side] = static_cast<float>(std::max(0.0, towards) / 2 * share);
    }
    const auto put = [&](double s, double t) {
        Point at{};
        for (std::size_t axis = 0; axis < 3; ++axis)
            at[axis] = triangle.corner[axis] + s * triangle.u[axis] + t * triangle.v[axis];
        Cell cell = cellOf(at);
        for (std::size_t axis = 0; axis < 3; ++axis)
            cell[axis] = std::clamp(cell[axis], kMargin, m_size[axis] - 1 - kMargin);
        const std::size_t index = indexOf(cell);
        m_holds[index] = std::max(m_holds[index], triangle.isClear ? kClear : kSurface);
        if (triangle.isClear) return;
        for (std::size_t side = 0; side < kSides; ++side) m_areas[index][side] += areas[side];
        if (!triangle.emits) return;
        if (m_lamps.empty() || m_lamps.back().cell != cell) m_lamps.push_back({cell, {}});
        for (std::size_t side = 0; side < kSides; ++side) m_lamps.back().areas[side] += areas[side];
    };
    // The middles of the small triangles that the net makes, so that each stands for its area.
    const double step = 1.0 / static_cast<double>(steps);
    for (std::int64_t i = 0; i < steps; ++i) {
        for (std::int64_t j = 0; i + j < steps; ++j) {
            const double s = static_cast<double>(i) * step, t = static_cast<double>(j) * step;
            put(s + step / 3, t + step / 3);
            if (i + j + 1 < steps) put(s + 2 * step / 3, t + 2 * step / 3);
        }
    }
}

}  // namespace pm::host
