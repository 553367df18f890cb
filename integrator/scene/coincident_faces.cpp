// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/scene/coincident_faces.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "integrator/materials/material_description.h"
#include "integrator/sampling/warps.h"
#include "integrator/scene/media.h"
#include "integrator/scene/shape_record.h"

namespace pm {

namespace {

// Faces that are looked at before the next look whether to go on.
constexpr std::size_t kGrain = 1024;
// Points of all faces together, where that is enough, and the most of one.
constexpr std::size_t kPoints = 1 << 16;
constexpr std::uint32_t kMostPoints = 256;
// A hit is another one too where they are no farther apart than this times what either may be off.
constexpr float kWindow = 4.0f;
// Of the way along a ray, beside what its end may be off.
constexpr float kRoundings = 4 * 0x1p-24f;
// Faces of all instances of a mesh that are looked at.
constexpr std::size_t kMostOfInstances = 1 << 20;
// Faces that a ray meets in one place and that are compared as sides of panes.
constexpr std::size_t kMostTogether = 8;

}  // namespace

// What is found on some faces.
struct Scene::CoincidentFaces::Found {
    std::vector<Face> faces;
    std::size_t doubledLamps = 0, hiddenSheets = 0, doubledGlass = 0;

    void join(const Found& other) {
        faces.insert(faces.end(), other.faces.begin(), other.faces.end());
        doubledLamps += other.doubledLamps;
        hiddenSheets += other.hiddenSheets;
        doubledGlass += other.doubledGlass;
    }
};

Scene::CoincidentFaces::Rank Scene::CoincidentFaces::rankOf(const Scene& scene, const Face& face) {
    const ShapeRecord& record = scene.m_shapes[face.shape];
    if (record.lightOf(face.primitive) != kNoLight) return Rank::kShining;
    const MaterialTraits& traits = scene.traits(record.materialOf(face.primitive));
    if (traits.isGlass) return Rank::kGlass;
    return traits.isSheet() ? Rank::kSheet : Rank::kOpaque;
}

// Whether a point of another face lies in a face's plane, and both lie alike, as far as rays can
// tell.
bool Scene::CoincidentFaces::isOn(const Scene& scene, const Face& face, const Surface& point) {
    const ShapeRecord& record = scene.m_shapes[face.shape];
    const Facet facet = record.facet(face.primitive);
    if (std::abs(dot(facet.normal, point.geometricNormal)) < 0.9f) return false;
    const Vec3d way = Vec3d(point.position) - record.corner(face.primitive).vertex;
    const float off = point.offset + surfaceOffset(point.position, facet.reach);
    return std::abs(dot(way, Vec3d(facet.normal))) <= 2.0 * static_cast<double>(off);
}

double Scene::CoincidentFaces::depthBehind(const Scene& scene, const Face& face,
                                           const Face& other) {
    const ShapeRecord& record = scene.m_shapes[face.shape];
    const Corner corner = record.corner(face.primitive);
    // The facet's own normal is rounded, which far corners would feel.
    const Vec3d normal = cross(corner.e1, corner.e2);
    const Vec3d way = scene.m_shapes[other.shape].corner(other.primitive).vertex - corner.vertex;
    const double depth = -dot(way, normal) / length(normal);
    return dot(normal, Vec3d(record.facet(face.primitive).normal)) < 0 ? -depth : depth;
}

bool Scene::CoincidentFaces::areOfPane(const Scene& scene, const Face& face, const Face& other) {
    const ShapeRecord &record = scene.m_shapes[face.shape], &ofOther = scene.m_shapes[other.shape];
    const std::uint32_t index = record.materialOf(face.primitive);
    const MaterialTraits& traits = scene.traits(index);
    return traits.isGlass && !traits.isCutAway && ofOther.mesh &&
           index == ofOther.materialOf(other.primitive) &&
           dot(record.facet(face.primitive).normal, ofOther.facet(other.primitive).normal) < 0.0f &&
           depthBehind(scene, face, other) > 0.0;
}

bool Scene::CoincidentFaces::areNeighbours(const Scene& scene, const Face& face,
                                           const Face& other) {
    const auto cornersOf = [&scene](const Face& one) {
        const Corner corner = scene.m_shapes[one.shape].corner(one.primitive);
        return std::array{corner.vertex, corner.vertex + corner.e1, corner.vertex + corner.e2};
    };
    const auto isIn = [](const Vec3d& point, const std::array<Vec3d, 3>& corners) {
        return std::ranges::any_of(corners, [&](const Vec3d& c) {
            return c.x == point.x && c.y == point.y && c.z == point.z;
        });
    };
    const std::array<Vec3d, 3> ours = cornersOf(face), theirs = cornersOf(other);
    const auto apex = std::ranges::find_if(ours, [&](const Vec3d& p) { return !isIn(p, theirs); });
    const auto beyond =
        std::ranges::find_if(theirs, [&](const Vec3d& p) { return !isIn(p, ours); });
    if (apex == ours.end() || beyond == theirs.end()) return false;
    const std::size_t at = static_cast<std::size_t>(apex - ours.begin());
    const Vec3d a = ours[(at + 1) % 3], b = ours[(at + 2) % 3];
    if (!isIn(a, theirs) || !isIn(b, theirs)) return false;
    return dot(cross(b - a, *apex - a), cross(b - a, *beyond - a)) < 0.0;
}

bool Scene::CoincidentFaces::areCutAlike(const Scene& scene, const Face& face, const Face& other) {
    const std::uint32_t index = scene.m_shapes[face.shape].materialOf(face.primitive);
    const MaterialDescription& material = scene.material(index);
    return material.transparency == 0.0f && material.opacityTexture != kNoTexture &&
           index == scene.m_shapes[other.shape].materialOf(other.primitive);
}

bool Scene::CoincidentFaces::isRanked(const Scene& scene, const Face& face, const Face& other) {
    const auto isOfBody = [&](const Face& one) {
        RayHit hit;
        hit.shape = one.shape;
        hit.primitive = one.primitive;
        return scene.m_media->isOfBody(hit);
    };
    return scene.m_media && priorityOf(scene, face) != priorityOf(scene, other) && isOfBody(face) &&
           isOfBody(other);
}

std::int32_t Scene::CoincidentFaces::priorityOf(const Scene& scene, const Face& face) {
    return scene.material(scene.m_shapes[face.shape].materialOf(face.primitive)).priority;
}

bool Scene::CoincidentFaces::hidesOther(const Scene& scene, const Face& face, const Face& other) {
    const Rank rank = rankOf(scene, face), ofOther = rankOf(scene, other);
    if (rank == Rank::kSheet && ofOther > rank) return true;
    if (ofOther != rank) return false;
    if (areNeighbours(scene, face, other)) return false;
    // Media know what is on both sides of all together, but between faces that look the same way a
    // layer is lost.
    if (rank == Rank::kGlass)
        return !areOfPane(scene, face, other) && !isRanked(scene, face, other) &&
               (!scene.m_media ||
                dot(scene.m_shapes[face.shape].facet(face.primitive).normal,
                    scene.m_shapes[other.shape].facet(other.primitive).normal) > 0.0f);
    if (rank == Rank::kSheet) return !areCutAlike(scene, face, other);
    return rank != Rank::kShining ||
           dot(scene.m_shapes[face.shape].facet(face.primitive).normal,
               scene.m_shapes[other.shape].facet(other.primitive).normal) > 0.0f;
}

void Scene::CoincidentFaces::search(const Scene& scene, const Face& face, std::uint32_t points,
                                    Found& found) {
    const ShapeRecord& record = scene.m_shapes[face.shape];
    const Corner corner = record.corner(face.primitive);
    if (!(lengthSquared(cross(corner.e1, corner.e2)) > 0)) return;
    const Rank rank = rankOf(scene, face);
    bool isAmong = false, isLost = false;
    for (std::uint32_t i = 0; i < points; ++i) {
        // The first one is the middle.
        const Vec2f b = i == 0 ? Vec2f{1.0f / 3, 1.0f / 3} : sampleTriangle(spreadPoint(i));
        Surface point;
        scene.surfaceOnTriangle(record, face.primitive, corner, static_cast<double>(b.x),
                                static_cast<double>(b.y), point);
        const float reach =
            kWindow * surfaceOffset(point.position, scene.roundingRadius(point.position));
        const Vec3f& normal = point.geometricNormal;
        const Ray through{point.position + normal * reach, -normal, 2 * reach};
        scene.m_tracer.forEachHit(through, 0.0f, [&](const RayHit& hit) {
            const Face other{hit.shape, hit.primitive};
            if (other == face || !isOn(scene, other, point)) return;
            found.faces.push_back(other);
            isAmong = true;
            isLost |= hidesOther(scene, face, other);
        });
    }
    if (isAmong) found.faces.push_back(face);
    if (isLost)
        ++(rank == Rank::kGlass   ? found.doubledGlass
           : rank == Rank::kSheet ? found.hiddenSheets
                                  : found.doubledLamps);
}

void Scene::CoincidentFaces::addNotices(const Found& found, std::vector<Notice>& notices) {
    if (found.doubledLamps > 0)
        notices.push_back(
            {NoticeCode::kDegenerateGeometry,
             fmt::format("{} triangles that shine lie on others that shine the same way: they "
                         "light twice and are seen once; leave one of each out",
                         found.doubledLamps)});
    if (found.hiddenSheets > 0)
        notices.push_back(
            {NoticeCode::kDegenerateGeometry,
             fmt::format("{} half-transparent triangles lie on others that are opaque or "
                         "half-transparent too: one of each two is not seen; leave a gap",
                         found.hiddenSheets)});
    if (found.doubledGlass > 0)
        notices.push_back(
            {NoticeCode::kDegenerateGeometry,
             fmt::format("{} triangles of glass lie on others of glass: light is bent by one of "
                         "each two only; leave a gap, or one of each out",
                         found.doubledGlass)});
}

std::unique_ptr<const Scene::CoincidentFaces> Scene::CoincidentFaces::find(
    const Scene& scene, std::vector<Notice>& notices, const CancelCheck& cancel) {
    std::vector<Face> special;
    // Of a mesh that is used very often, only where it stands first.
    std::map<const TriangleMesh*, std::size_t> looked;
    const auto looksAt = [&](const ShapeRecord& record) {
        std::size_t& faces = looked[record.mesh.get()];
        const bool isMore = faces > 0;
        faces += record.mesh->triangles.size();
        return !isMore || faces <= kMostOfInstances;
    };
    for (std::uint32_t shape = 0; shape < scene.m_shapes.size(); ++shape) {
        const ShapeRecord& record = scene.m_shapes[shape];
        if (!record.mesh) continue;
        const bool mayBe = std::ranges::any_of(record.materials, [&](std::uint32_t m) {
            const MaterialTraits& traits = scene.traits(m);
            return (traits.isGlass && !traits.isInvisible) || traits.isSheet() || traits.emits;
        });
        if (!mayBe || (record.placement && !looksAt(record))) continue;
        for (std::uint32_t i = 0; i < record.mesh->triangles.size(); ++i)
            if (rankOf(scene, {shape, i}) != Rank::kOpaque &&
                !scene.traits(record.materialOf(i)).isInvisible)
                special.push_back({shape, i});
    }
    if (special.empty()) return nullptr;
    const auto points = static_cast<std::uint32_t>(
        std::clamp<std::size_t>(kPoints / special.size(), 1, kMostPoints));
    Found all = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, special.size(), kGrain), Found{},
        [&](const auto& range, Found found) {
            cancel.throwIfSet("looking for faces that lie on others");
            for (std::size_t i = range.begin(); i < range.end(); ++i)
                search(scene, special[i], points, found);
            return found;
        },
        [](Found a, const Found& b) {
            a.join(b);
            return a;
        });
    addNotices(all, notices);
    if (all.faces.empty()) return nullptr;
    return std::unique_ptr<const CoincidentFaces>(new CoincidentFaces(scene, all.faces));
}

Scene::CoincidentFaces::CoincidentFaces(const Scene& scene, const std::vector<Face>& faces)
    : m_scene(scene), m_isAmong(scene.m_shapes.size()) {
    for (const Face& face : faces) {
        auto& ofShape = m_isAmong[face.shape];
        if (ofShape.empty()) ofShape.resize(scene.m_shapes[face.shape].mesh->triangles.size());
        ofShape[face.primitive] = true;
    }
}

RayHit Scene::CoincidentFaces::chosen(const Ray& ray, const RayHit& nearest) const {
    const auto& isAmong = m_isAmong[nearest.shape];
    if (isAmong.empty() || !isAmong[nearest.primitive]) return nearest;
    const Facet facet = m_scene.m_shapes[nearest.shape].facet(nearest.primitive);
    const float slope = std::abs(dot(facet.normal, ray.direction));
    const float offset = surfaceOffset(ray.origin + ray.direction * nearest.t, facet.reach);
    const float window = kWindow * (offset / slope + kRoundings * nearest.t);
    if (!(window < nearest.t)) return nearest;  // along the face, or from it
    RayHit best = nearest;
    auto bestOrder = orderFor(ray, {nearest.shape, nearest.primitive});
    std::array<RayHit, kMostTogether> met;
    std::size_t metCount = 0;
    m_scene.m_tracer.forEachHit({ray.origin, ray.direction, nearest.t + window, ray.viewer},
                                nearest.t - window, [&](const RayHit& hit) {
                                    if (metCount < met.size()) met[metCount++] = hit;
                                    const Face face{hit.shape, hit.primitive};
                                    const auto order = orderFor(ray, face);
                                    if (!(order < bestOrder)) return;
                                    bestOrder = order;
                                    best = hit;
                                });
    if (rankOf(m_scene, {best.shape, best.primitive}) != Rank::kGlass) return best;
    return nearSide(ray, {met.data(), metCount}, best);
}

RayHit Scene::CoincidentFaces::nearSide(const Ray& ray, std::span<const RayHit> met,
                                        const RayHit& soFar) const {
    const auto isEntered = [&](const RayHit& hit) {
        return dot(m_scene.m_shapes[hit.shape].facet(hit.primitive).normal, ray.direction) < 0.0f;
    };
    for (const RayHit& entered : met) {
        const ShapeRecord& record = m_scene.m_shapes[entered.shape];
        if (!record.mesh || !isEntered(entered)) continue;
        const Face face{entered.shape, entered.primitive};
        for (const RayHit& left : met) {
            const Face other{left.shape, left.primitive};
            if (!m_scene.m_shapes[left.shape].mesh || isEntered(left) ||
                !areOfPane(m_scene, face, other))
                continue;
            const float offset = surfaceOffset(ray.origin + ray.direction * entered.t,
                                               record.facet(entered.primitive).reach);
            RayHit hit = entered;
            hit.isPane =
                depthBehind(m_scene, face, other) <= static_cast<double>(kThickestPane * offset);
            return hit;
        }
    }
    return soFar;
}

Scene::CoincidentFaces::Order Scene::CoincidentFaces::orderFor(const Ray& ray,
                                                               const Face& face) const {
    Rank rank = rankOf(m_scene, face);
    const Vec3f normal = m_scene.m_shapes[face.shape].facet(face.primitive).normal;
    // Lamps shine from their fronts only.
    if (rank == Rank::kShining && dot(normal, ray.direction) >= 0.0f) rank = Rank::kOpaque;
    return {-static_cast<int>(rank),
            rank == Rank::kGlass && m_scene.m_media ? -priorityOf(m_scene, face) : 0, face};
}

std::uint64_t Scene::CoincidentFaces::memoryBytes() const {
    std::uint64_t bytes = m_isAmong.size() * sizeof(m_isAmong[0]);
    for (const std::vector<bool>& one : m_isAmong) bytes += one.size() / 8;
    return bytes;
}

}  // namespace pm
