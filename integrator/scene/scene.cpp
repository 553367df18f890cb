// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "integrator/materials/material_description.h"
#include "integrator/scene/coincident_faces.h"
#include "integrator/scene/media.h"
#include "integrator/scene/shape_record.h"

namespace pm {

namespace {

constexpr std::size_t kTrianglesBetweenLooks = 1 << 16;

}  // namespace

Scene::~Scene() = default;

void Scene::place(const Box3d& whole, const std::optional<Box3d>& core) {
    m_centre = whole.middle();
    m_halfSize = whole.size() * 0.5;
    Vec3d lo = m_centre - m_halfSize, hi = m_centre + m_halfSize;
    if (core) {
        lo = whole.lo;
        hi = whole.hi;
        m_centre = core->middle();
        for (int axis = 0; axis < 3; ++axis)
            m_halfSize[axis] = std::max(m_centre[axis] - lo[axis], hi[axis] - m_centre[axis]);
    }
    m_bounds = {lo.x, lo.y, lo.z, hi.x, hi.y, hi.z};
    m_radius = length(m_halfSize);
    m_coreRadius = core ? 0.5 * length(core->size()) : m_radius;
    if (!core) return;
    constexpr double kRounding = 0x1p-24;
    const double farthest = maxAbsComponent(m_halfSize);
    if (kRounding * farthest <= maxAbsComponent(core->size())) return;
    m_notices.push_back(
        {NoticeCode::kDegenerateGeometry,
         fmt::format(
             "the scene reaches {:.3g} units from where most of it lies, {:.3g} units wide: "
             "the former is placed to {:.1g} units only, the latter to {:.1g}",
             farthest, maxAbsComponent(core->size()), kRounding * farthest,
             kRounding * 0.5 * maxAbsComponent(core->size()))});
}

Ray Scene::rayFromAfar(const Vec3d& origin, const Vec3d& direction) const {
    const Ray ray{Vec3f(origin), Vec3f(direction)};
    // Of the core's sphere: it holds what is rounded no more than the core is.
    constexpr double kNearRadii = 2.0;
    const double t =
        intersectSphere(origin, direction, 1e300, Vec3d(0.0), kNearRadii * m_coreRadius);
    if (!(t > 0) ||
        !(lengthSquared(origin) > 4 * kNearRadii * kNearRadii * m_coreRadius * m_coreRadius))
        return ray;
    const Ray near{Vec3f(origin + direction * t), ray.direction};
    // What is near the origin itself has been left.
    const auto way = static_cast<float>(t * (1 - 1e-6));
    return occluded({near.origin, -near.direction, way}) ? ray : near;
}

Rgb Scene::skyRadiance(const Surface& from, const Vec3f& normal, const Vec3f& direction) const {
    if (!(dot(direction, normal) > 0.0f)) return {};
    const Rgb radiance = m_environment->radiance(direction);
    return isBlack(radiance) ? Rgb{} : radiance * transmittance(rayFrom(from, direction));
}

bool Scene::seesFarLight(const Vec3f& direction) const {
    return std::ranges::any_of(
        farLights(), [&](const Light& light) { return !isBlack(light.farRadiance(direction)); });
}

bool Scene::findFlat(const CancelCheck& cancel) const {
    // The plane's normal is the sum over all triangles: what rounding does to inner vertices
    // cancels.
    Vec3d normal, origin;
    const auto reflects = [&](const ShapeRecord& record, std::uint32_t primitive) {
        const MaterialTraits& traits = m_traits[record.materialOf(primitive)];
        return !traits.isBlack && !traits.isInvisible;
    };
    const auto forEachTriangle = [&](const auto& visit) {
        for (const ShapeRecord& record : m_shapes) {
            if (!record.mesh) continue;
            const auto& triangles = record.mesh->triangles;
            for (std::size_t i = 0; i < triangles.size(); ++i) {
                if (i % kTrianglesBetweenLooks == 0) cancel.throwIfSet("building the scene");
                if (reflects(record, static_cast<std::uint32_t>(i)) &&
                    !visit(record.vertex(triangles[i][0]), record.vertex(triangles[i][1]),
                           record.vertex(triangles[i][2])))
                    return false;
            }
        }
        return true;
    };
    for (const ShapeRecord& record : m_shapes)
        if (!record.mesh && (record.groups || reflects(record, 0))) return false;
    forEachTriangle([&](const Vec3d& v0, const Vec3d& v1, const Vec3d& v2) {
        const Vec3d n = cross(v1 - v0, v2 - v0);
        normal += dot(n, normal) < 0 ? -n : n;
        origin = v0;
        return true;
    });
    if (!(length(normal) > 0)) return false;
    normal = normalize(normal);
    return forEachTriangle([&](const Vec3d& v0, const Vec3d& v1, const Vec3d& v2) {
        const double size = maxAbsComponent(v1 - v0) + maxAbsComponent(v2 - v0);
        for (const Vec3d& v : {v0, v1, v2}) {
            // As much as rounding to float may lift this triangle's vertices, and not what it may
            // lift the farthest: a huge ground must not swallow what stands on it.
            const double tolerance = 32 * 0x1p-24 * (length(v) + size);
            if (std::abs(dot(v - origin, normal)) > tolerance) return false;
        }
        return true;
    });
}

std::uint64_t Scene::memoryBytes() const {
    std::uint64_t bytes = m_tracer.memoryBytes();
    std::set<const TriangleMesh*> instanced;
    std::set<const Tangents*> withTangents;
    std::set<const LimitShape*> limits;
    for (const ShapeRecord& record : m_shapes) {
        bytes += sizeof(ShapeRecord);
        if (record.tangents && withTangents.insert(record.tangents.get()).second)
            bytes += record.tangents->memoryBytes();
        if (record.groups) {
            bytes += record.groups->memoryBytes();
            if (limits.insert(&record.groups->shape()).second)
                bytes += record.groups->shape().memoryBytes();
        }
        if (record.placement) {
            if (!instanced.insert(record.mesh.get()).second) continue;
            bytes += record.mesh->rayTracing
                         .get<SharedMesh>([](const SharedMesh&) { return true; },
                                          [] { return std::shared_ptr<const SharedMesh>(); })
                         ->memoryBytes();
        }
        bytes += record.positions.size() * sizeof(Vec3f) + record.normals.size() * sizeof(Vec3f) +
                 record.lightOfPrimitive.size() * sizeof(std::int32_t);
        bytes += record.facets.size() * sizeof(Facet);
        if (record.mesh)
            bytes += record.mesh->positions.size() * sizeof(Vec3f) +
                     record.mesh->triangles.size() * (sizeof(TriangleMesh::Corners) + 8);
    }
    if (m_environment) bytes += m_environment->memoryBytes();
    for (const LampTexture& texture : m_lampTextures) bytes += texture.memoryBytes();
    if (m_coincident) bytes += m_coincident->memoryBytes();
    if (m_media) bytes += m_media->memoryBytes();
    return bytes + describedBytes();
}

// Of what there may be very many of, with what is made of it for rays and for the choice of lights.
std::uint64_t Scene::describedBytes() const {
    // Measured, of 100,000 and more: the tree and lists of the choice; the ray tracer's own record.
    constexpr std::uint64_t kChoiceBytes = 300, kPlacedBytes = 560;
    // Of names and short lists.
    constexpr std::uint64_t kBesideBytes = 80;
    const SceneDescription& d = m_description;
    std::uint64_t bytes = m_lights.size() * (sizeof(Light) + sizeof(LampTriangle) + kChoiceBytes) +
                          d.lights.size() * sizeof(LightDescription) +
                          d.materials.size() * (sizeof(MaterialDescription) + kBesideBytes) +
                          d.instances.size() * (sizeof(InstanceDescription) + kBesideBytes);
    for (const ShapeRecord& record : m_shapes)
        if (record.placement) bytes += kPlacedBytes;
    if (d.textures) bytes += d.textures->memoryBytes();
    return bytes;
}

}  // namespace pm
