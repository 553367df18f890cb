// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/tessellation/limit_groups.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "integrator/tessellation/patch_bounds.h"
#include "integrator/values/error.h"
#include "integrator/values/morton.h"

namespace pm {

namespace {

// Fewer cost more boxes, more cost more that rays don't need.
constexpr std::uint32_t kTrianglesOfGroup = 1024;

}  // namespace

LimitGroups::LimitGroups(std::shared_ptr<const LimitShape> shape, const Transform& toScene,
                         std::vector<const HeightField*> heights, const TessellationRule& rule,
                         const CancelCheck& cancel, std::vector<bool> slotsLeftOut)
    : m_shape(std::move(shape)),
      m_placed{*m_shape, toScene, std::move(heights), edgeRates(*m_shape, toScene, rule, cancel)},
      m_slotsLeftOut(std::move(slotsLeftOut)) {
    listGroups(cancel);
    m_met = std::vector<MetBox>(m_groups.size());
    findBoxes(cancel);
}

std::uint32_t LimitGroups::slotOf(std::uint32_t face) const {
    const auto& slots = m_shape->cage().mesh.faceMaterials;
    return slots.empty() ? 0 : slots[face];
}

// By slot, then so that near faces follow each other.
std::vector<std::uint32_t> LimitGroups::facesInOrder(const CancelCheck& cancel) const {
    const PolygonMesh& mesh = m_shape->cage().mesh;
    std::vector<Vec3d> middles(mesh.faceCount());
    Box3d box;
    std::size_t corner = 0;
    for (std::size_t face = 0; face < middles.size(); ++face) {
        const std::uint32_t size = mesh.faceVertexCounts[face];
        for (std::uint32_t i = 0; i < size; ++i, ++corner)
            middles[face] += Vec3d(mesh.positions[mesh.vertexIndices[corner]]) / size;
        box.grow({middles[face], middles[face]});
    }
    cancel.throwIfSet("tessellating");
    const double widest = std::max(maxAbsComponent(box.size()), 1e-300);
    std::vector<std::tuple<std::uint32_t, std::uint64_t, std::uint32_t>> keys;
    for (std::uint32_t face = 0; face < middles.size(); ++face) {
        if (!m_shape->surface().hasSurface(face) || isLeftOut(slotOf(face))) continue;
        const Vec3d at = (middles[face] - box.lo) * (65535.0 / widest);
        const auto cell = [](double v) { return static_cast<std::uint32_t>(v); };
        keys.emplace_back(slotOf(face), mortonKey({cell(at.x), cell(at.y), cell(at.z)}), face);
    }
    std::ranges::sort(keys);
    std::vector<std::uint32_t> faces;
    for (const auto& key : keys) faces.push_back(std::get<2>(key));
    return faces;
}

void LimitGroups::listGroups(const CancelCheck& cancel) {
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
    const SubdivisionScheme scheme = m_shape->cage().scheme;
    LimitPoints points(m_placed);
    std::uint32_t inGroup = 0;
    for (const std::uint32_t face : facesInOrder(cancel)) {
        cancel.throwIfSet("tessellating");
        points.select(face);
        const std::uint32_t parts = patternParts(scheme, points.rates());
        for (std::uint32_t part = 0; part < parts; ++part) {
            const std::uint32_t triangles = patternTriangles(scheme, points.rates(), part);
            if (triangles == 0) continue;
            const bool isNew = m_groups.empty() || m_groups.back().slot != slotOf(face) ||
                               inGroup + triangles > kTrianglesOfGroup;
            if (isNew) {
                m_groups.push_back({static_cast<std::uint32_t>(m_items.size()),
                                    static_cast<std::uint32_t>(m_triangleCount),
                                    slotOf(face),
                                    {}});
                inGroup = 0;
            }
            m_items.push_back({face, part});
            inGroup += triangles;
            m_triangleCount += triangles;
            if (m_triangleCount > kMost)
                throw Error(Status::kInvalidScene,
                            fmt::format("a cage of {} faces makes more than {} triangles",
                                        m_shape->cage().mesh.faceCount(), kMost));
        }
    }
}

Box3d LimitGroups::boxOf(const Item& item, LimitPoints& points) const {
    points.select(item.face);
    const SubdivisionScheme scheme = m_shape->cage().scheme;
    if (points.isBicubic())
        return boundsOfBicubic(patternDomain(scheme, points.rates(), item.part),
                               [&](const LimitPoints::UV& uv) { return points.limitPosition(uv); });
    if (patternParts(scheme, points.rates()) == 1) return points.hull();
    // Of a large face that is no such patch: its own points say it.
    FacePattern pattern;
    makePattern(scheme, points.rates(), item.part, pattern);
    Box3d box;
    for (const PatternPoint& point : pattern.points) {
        const Vec3d p = points.limitPosition(point.uv);
        box.grow({p, p});
    }
    return box;
}

void LimitGroups::findBoxes(const CancelCheck& cancel) {
    // What is at a group's rim may be displaced as a face of another slot says.
    double highest = 0.0;
    for (const HeightField* const heights : m_placed.heights)
        if (heights)
            for (const double end : heights->range()) highest = std::max(highest, std::abs(end));
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, groupCount()), [&](const auto& range) {
        for (std::uint32_t group = range.begin(); group < range.end(); ++group) {
            cancel.throwIfSet("tessellating");
            LimitPoints points(m_placed);
            const std::uint32_t end = group + 1 < groupCount()
                                          ? m_groups[group + 1].firstItem
                                          : static_cast<std::uint32_t>(m_items.size());
            Box3d& box = m_groups[group].box;
            for (std::uint32_t i = m_groups[group].firstItem; i < end; ++i)
                box.grow(boxOf(m_items[i], points));
            // Neighbours' patches differ at their edge by what OpenSubdiv's approximation is off;
            // float's roundings are less.
            constexpr double kApproximation = 1e-5;
            const Vec3d more(highest + kApproximation * maxAbsComponent(box.size()) +
                             0x1p-22 * std::max(maxAbsComponent(box.lo), maxAbsComponent(box.hi)));
            box = {box.lo - more, box.hi + more};
        }
    });
    for (const Group& group : m_groups) m_box.grow(group.box);
    if (m_groups.empty()) return;
    const double farthest = std::max(maxAbsComponent(m_box.lo), maxAbsComponent(m_box.hi));
    if (!(farthest <= static_cast<double>(kMaxCoordinate)))
        throw Error(Status::kInvalidScene,
                    fmt::format("the limit surface reaches {}; at most +-{} is allowed", farthest,
                                kMaxCoordinate));
}

std::uint32_t LimitGroups::trianglesOf(std::uint32_t group) const {
    const std::uint64_t end =
        group + 1 < groupCount() ? m_groups[group + 1].firstTriangle : m_triangleCount;
    return static_cast<std::uint32_t>(end - m_groups[group].firstTriangle);
}

std::uint32_t LimitGroups::groupOf(std::uint32_t triangle) const {
    const auto after = std::ranges::upper_bound(m_groups, triangle, {}, &Group::firstTriangle);
    return static_cast<std::uint32_t>(after - m_groups.begin()) - 1;
}

std::unique_ptr<const TriangleGroup> LimitGroups::make(std::uint32_t group) const {
    const std::uint32_t end = group + 1 < groupCount() ? m_groups[group + 1].firstItem
                                                       : static_cast<std::uint32_t>(m_items.size());
    LimitPoints evaluated(m_placed);
    FacePattern pattern;
    std::vector<TriangleGroup::Point> points;
    std::vector<TriangleGroup::Corners> triangles;
    triangles.reserve(trianglesOf(group));
    for (std::uint32_t i = m_groups[group].firstItem; i < end; ++i) {
        evaluated.select(m_items[i].face);
        makePattern(m_shape->cage().scheme, evaluated.rates(), m_items[i].part, pattern);
        const auto first = static_cast<std::uint32_t>(points.size());
        for (const PatternPoint& point : pattern.points) points.push_back(evaluated.point(point));
        for (const auto& [a, b, c] : pattern.facets)
            triangles.push_back({first + a, first + b, first + c});
    }
    return std::make_unique<const TriangleGroup>(points, triangles);
}

void LimitGroups::forEachCageTriangle(
    std::uint32_t slot, const std::function<void(const std::array<Vec3d, 3>&)>& visit) const {
    if (isLeftOut(slot)) return;
    const PolygonMesh& mesh = m_shape->cage().mesh;
    std::size_t first = 0;
    for (std::uint32_t face = 0; face < mesh.faceCount(); first += mesh.faceVertexCounts[face++]) {
        if (slotOf(face) != slot || !m_shape->surface().hasSurface(face)) continue;
        const auto corner = [&](std::uint32_t i) {
            return transformPoint(m_placed.toScene,
                                  Vec3d(mesh.positions[mesh.vertexIndices[first + i]]));
        };
        for (std::uint32_t i = 2; i < mesh.faceVertexCounts[face]; ++i)
            visit({corner(0), corner(i - 1), corner(i)});
    }
}

std::uint64_t LimitGroups::memoryBytes() const {
    return m_items.size() * sizeof(Item) + m_groups.size() * (sizeof(Group) + sizeof(MetBox)) +
           m_placed.rates.size() * sizeof(std::uint16_t) + GroupCache::bytesFor(m_groups.size());
}

}  // namespace pm
