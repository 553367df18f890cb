// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Points on surfaces: of a hit only the primitive is taken; where it is met is computed again in
// double and rounded once, so that the error is known (see surfaceOffset).
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "integrator/sampling/warps.h"
#include "integrator/scene/coincident_faces.h"
#include "integrator/scene/media.h"
#include "integrator/scene/scene.h"
#include "integrator/scene/shape_record.h"
#include "integrator/shapes/surface.h"

namespace pm {

namespace {

// The intersector tells a triangle from its neighbour to some roundings of its size only, so a
// point may lie so far, in barycentric coordinates, beyond the edge of the one that is told. Put
// back onto the edge, points of a huge ground would be units away from where they are.
constexpr double kBeyondEdges = 32 * 0x1p-24;

// Barycentric coordinates of where a line meets a triangle's plane, clamped into the triangle but
// for kBeyondEdges. Source: Moeller & Trumbore, 1997, in double.
void barycentrics(const Ray& ray, const Vec3d& v0, const Vec3d& e1, const Vec3d& e2, double& b1,
                  double& b2) {
    const Vec3d direction(ray.direction);
    const Vec3d p = cross(direction, e2);
    const double determinant = dot(e1, p);
    b1 = b2 = 1.0 / 3;
    if (determinant == 0.0) return;  // seen exactly edge-on: any point of it serves
    const double inverse = 1.0 / determinant;
    const Vec3d s = Vec3d(ray.origin) - v0;
    constexpr double kLeast = -kBeyondEdges, kMost = 1.0 + kBeyondEdges;
    b1 = std::clamp(dot(s, p) * inverse, kLeast, kMost);
    b2 = std::clamp(dot(direction, cross(s, e1)) * inverse, kLeast, std::max(kLeast, kMost - b1));
}

// How much more than a well-shaped triangle's the normal that the intersector finds in float may be
// off: it takes the cross product of the shortest edge and another, rounded by u times the product
// of their lengths, so that the error relative to the area grows for slivers without a short edge.
// Cut where the offset would be a thousandth of the triangle's size.
double normalCondition(const Vec3d& e1, const Vec3d& e2, double twiceArea) {
    constexpr double kLargest = 1000;
    const double a = lengthSquared(e1), b = lengthSquared(e2), c = lengthSquared(e2 - e1);
    const double squared = std::min({a, b, c}) * std::max({a, b, c});
    const double areaSquared = twiceArea * twiceArea;
    if (squared <= areaSquared) return 1.0;
    return squared < kLargest * kLargest * areaSquared ? std::sqrt(squared) / twiceArea : kLargest;
}

// The same by the triangle's box: each component of what the intersector sums up is rounded by u
// times no more than the box's volume, some 72 times in all (4.5 times surfaceOffset's 16), and the
// sum divided by twice the area. So a huge ground that lies along two axes is as exact as a small
// one; a sliver's box says less than its edges.
double reachByBox(const Vec3d& e1, const Vec3d& e2, double twiceArea) {
    double volume = 1.0;
    for (int axis = 0; axis < 3; ++axis)
        volume *= std::max({0.0, e1[axis], e2[axis]}) - std::min({0.0, e1[axis], e2[axis]});
    return 4.5 * volume / twiceArea;
}

Vec3f interpolateNormal(const Vec3f& n0, const Vec3f& n1, const Vec3f& n2, float b1, float b2,
                        const Vec3f& geometricNormal) {
    Vec3f n = n0 * (1.0f - b1 - b2) + n1 * b1 + n2 * b2;
    const float l2 = lengthSquared(n);
    if (!(l2 > 1e-12f)) return geometricNormal;
    // Files wind triangles the other way round than their normals say; fronts are by winding.
    const bool isTurned = dot(n0 + n1 + n2, geometricNormal) < 0.0f;
    n = n / (isTurned ? -std::sqrt(l2) : std::sqrt(l2));
    // A normal beyond the horizon of its own triangle says nothing usable about its front.
    return dot(n, geometricNormal) > 0.0f ? n : geometricNormal;
}

// That of a line's roots which a hit's distance was rounded from.
double rootOf(const CurvedShape& shape, const Vec3d& origin, const Vec3d& direction, float t) {
    const auto told = static_cast<double>(t);
    const RayRoots roots = shape.roots(origin, direction);
    double best = told, off = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < roots.count; ++i)
        if (std::abs(roots.t[i] - told) < off) {
            best = roots.t[i];
            off = std::abs(best - told);
        }
    return best;
}

Vec2f interpolateTexcoords(const std::array<Vec2f, 3>& corners, float b1, float b2) {
    const float b0 = 1.0f - b1 - b2;
    return {corners[0].x * b0 + corners[1].x * b1 + corners[2].x * b2,
            corners[0].y * b0 + corners[1].y * b1 + corners[2].y * b2};
}

}  // namespace

Scene::Facet::Facet(const Corner& corner, bool mirrored, bool exact) {
    Vec3d n = cross(corner.e1, corner.e2);
    if (mirrored) n = -n;
    const double twiceArea = length(n);
    normal = twiceArea > 0 ? Vec3f(n / twiceArea) : Vec3f{0.0f, 1.0f, 0.0f};
    const double longest = std::sqrt(std::max({lengthSquared(corner.e1), lengthSquared(corner.e2),
                                               lengthSquared(corner.e2 - corner.e1)}));
    const double byEdges = longest * normalCondition(corner.e1, corner.e2, twiceArea);
    if (exact) {
        // Some roundings in double of what surfaceOffset takes for roundings of float.
        reach = static_cast<float>(0x1p-26 * byEdges);
        return;
    }
    // Never 0: in the scene's very centre a point's own rounding is 0 too.
    constexpr double kLeast = 0x1p-30;
    reach =
        static_cast<float>(twiceArea > 0 ? std::clamp(reachByBox(corner.e1, corner.e2, twiceArea),
                                                      kLeast * longest, byEdges)
                                         : byEdges);
}

bool Scene::intersect(const Ray& ray, Surface& surface, RayFootprint* footprint) const {
    return find(surface, {&ray, footprint && footprint->isKnown ? footprint : nullptr, false});
}

bool Scene::meet(const Ray& ray, Surface& surface) const {
    return find(surface, {&ray, nullptr, true});
}

bool Scene::find(Surface& surface, const Arrival& arrival) const {
    if (!m_media) return findFace(surface, arrival);
    Ray ray = *arrival.ray;
    // Faces that are none are few; one that rays can't leave ends the search.
    constexpr int kMostFaces = 256;
    for (int i = 0; i < kMostFaces; ++i) {
        if (!findFace(surface, {&ray, arrival.footprint, arrival.ofShapeOnly})) return false;
        if (m_media->resolve(ray.direction, surface)) return true;
        const Vec3f onwards = rayOrigin(surface, ray.direction);
        ray.tMax -= std::sqrt(lengthSquared(onwards - ray.origin) / lengthSquared(ray.direction));
        ray.origin = onwards;
        if (!(ray.tMax > 0.0f)) return false;
    }
    return false;
}

bool Scene::findFace(Surface& surface, const Arrival& arrival) const {
    RayHit hit;
    if (!m_tracer.intersect(*arrival.ray, hit)) return false;
    if (m_coincident) hit = m_coincident->chosen(*arrival.ray, hit);
    surfaceAt(hit, surface, arrival);
    surface.isPane = hit.isPane || (m_hasThinWalls && m_materials[surface.material].thinWalled);
    if (hit.isPane) surface.offset *= CoincidentFaces::kBeyondPane;
    if (surface.isPane) {
        surface.shadingNormal = surface.geometricNormal;
        if (RayFootprint* const footprint = arrival.footprint)
            footprint->x.normal = footprint->y.normal = Vec3f(0.0f);
    }
    return true;
}

void Scene::surfaceAt(const RayHit& hit, Surface& surface, const Arrival& arrival) const {
    const ShapeRecord& record = m_shapes[hit.shape];
    surface.shape = hit.shape;
    const Ray& ray = *arrival.ray;
    surface.time = ray.time;
    if (!record.curved) {
        const Corner corner = record.corner(hit.primitive);
        double b1, b2;
        barycentrics(ray, corner.vertex, corner.e1, corner.e2, b1, b2);
        surfaceOnTriangle(record, hit.primitive, corner, b1, b2, surface, arrival);
        return;
    }
    const Vec3d origin(ray.origin), direction(ray.direction);
    const Vec3d point = origin + direction * rootOf(*record.curved, origin, direction, hit.t);
    surface.tangent = {};
    record.curved->surfaceNear(point, surface);
    nameSurface(record, 0, surface);
    surface.footprint = {};
    if (arrival.footprint) footprintOnCurved(record, arrival, surface);
}

void Scene::surfaceOnTriangle(const ShapeRecord& record, std::uint32_t primitive,
                              const Corner& corner, double b1, double b2, Surface& surface,
                              const Arrival& arrival) const {
    const Attributes attributes = record.attributes(primitive);
    const auto& [v0, e1, e2] = corner;
    surface.position = Vec3f(v0 + (e1 * b1 + e2 * b2));
    const Facet facet = record.facet(primitive, corner);
    surface.offset = surfaceOffset(surface.position, facet.reach);
    surface.geometricNormal = surface.shadingNormal = facet.normal;
    const auto f1 = static_cast<float>(b1), f2 = static_cast<float>(b2);
    if (attributes.hasNormals) {
        const auto& [n0, n1, n2] = attributes.normals;
        surface.shadingNormal = interpolateNormal(n0, n1, n2, f1, f2, surface.geometricNormal);
    }
    surface.uv = {};
    surface.tangent = {};
    surface.footprint = {};
    if (arrival.footprint)
        footprintOnTriangle(m_traits[record.materialOf(primitive)], attributes, corner, {f1, f2},
                            arrival, surface);
    if (attributes.hasTexcoords) {
        const auto& [t0, t1, t2] = attributes.texcoords;
        surface.uv = interpolateTexcoords(attributes.texcoords, f1, f2);
        if (record.hasMaps && !arrival.ofShapeOnly) {
            // Of caustics every facet counts.
            const bool isFinest = arrival.footprint && arrival.footprint->isWide &&
                                  m_traits[record.materialOf(primitive)].castsCaustics;
            applyMaps(record, primitive, attributes,
                      {e1, e2, {t1.x - t0.x, t1.y - t0.y}, {t2.x - t0.x, t2.y - t0.y}}, {f1, f2},
                      isFinest ? UvFootprint{} : surface.footprint, surface);
        }
    }
    nameSurface(record, primitive, surface);
}

TextureContext Scene::contextAt(const Ray& ray, const RayHit& hit) const {
    const ShapeRecord& record = m_shapes[hit.shape];
    if (record.curved) {
        Surface surface;
        surfaceAt(hit, surface, {&ray, nullptr, true});
        return {surface.uv, surface.position, {}};
    }
    const Corner corner = record.corner(hit.primitive);
    double b1, b2;
    barycentrics(ray, corner.vertex, corner.e1, corner.e2, b1, b2);
    TextureContext at;
    at.place = Vec3f(corner.vertex + (corner.e1 * b1 + corner.e2 * b2));
    std::array<Vec2f, 3> texcoords;
    if (record.texcoords(hit.primitive, texcoords))
        at.uv = interpolateTexcoords(texcoords, static_cast<float>(b1), static_cast<float>(b2));
    return at;
}

void Scene::nameSurface(const ShapeRecord& record, std::uint32_t primitive, Surface& surface) {
    surface.primitive = primitive;
    surface.material = record.materialOf(primitive);
    surface.light = record.lightOf(primitive);
    surface.instanceId = record.instanceId;
}

Surface Scene::pointOnLight(const SurfaceLight& light, Vec2f u) const {
    const ShapeRecord& record = m_shapes[light.shape];
    if (!record.mesh) return pointOnSphere(light.shape, Vec3d(sampleUniformSphere(u)));
    Surface surface;
    surface.shape = light.shape;
    const Vec2f b = sampleTriangle(u);
    surfaceOnTriangle(record, light.primitive, record.corner(light.primitive),
                      static_cast<double>(b.x), static_cast<double>(b.y), surface);
    return surface;
}

Surface Scene::pointOnSphere(std::uint32_t shape, const Vec3d& direction) const {
    Surface surface;
    surface.shape = shape;
    m_shapes[shape].curved->sphere()->surfaceAlong(direction, surface);
    nameSurface(m_shapes[shape], 0, surface);
    return surface;
}

SphereShape Scene::sphere(std::uint32_t shape) const {
    return m_shapes[shape].curved->sphere()->sphere();
}

bool Scene::isSphere(std::uint32_t shape) const {
    const std::optional<CurvedShape>& curved = m_shapes[shape].curved;
    return curved && curved->sphere() != nullptr;
}

SphereShape Scene::ballAround(std::uint32_t shape) const {
    const ShapeRecord& record = m_shapes[shape];
    if (!record.groups) return record.curved->ball();
    const Box3d& box = record.groups->box();
    return {box.middle(), 0.5 * length(box.size())};
}

std::uint32_t Scene::partCount(std::uint32_t shape) const {
    return m_shapes[shape].groups ? m_shapes[shape].groups->groupCount() : 1;
}

SphereShape Scene::ballAroundPart(std::uint32_t shape, std::uint32_t part) const {
    if (!m_shapes[shape].groups) return ballAround(shape);
    const Box3d& box = m_shapes[shape].groups->box(part);
    return {box.middle(), 0.5 * length(box.size())};
}

}  // namespace pm
