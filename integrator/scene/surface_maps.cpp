// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What maps over a mesh, and the directions in which its texture coordinates grow, do to a point of
// it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "integrator/scene/scene.h"
#include "integrator/scene/shape_record.h"
#include "integrator/shapes/bump_map.h"
#include "integrator/shapes/normal_map.h"
#include "integrator/shapes/tangents.h"

namespace pm {

namespace {

bool hasReliefMap(const MaterialDescription& material) {
    return material.normalTexture != kNoTexture || material.bumpTexture != kNoTexture;
}

bool asksForTangents(const MaterialDescription& material) {
    return material.normalTexture != kNoTexture || material.anisotropy > 0.0f;
}

Vec3f interpolated(const std::array<Vec3f, 3>& corners, Vec2f b) {
    return corners[0] * (1.0f - b.x - b.y) + corners[1] * b.x + corners[2] * b.y;
}

Vec3f moved(const Transform& m, const Vec3f& v) {
    const Vec3d d(v);
    const Vec3d image{dot(row(m, 0), d), dot(row(m, 1), d), dot(row(m, 2), d)};
    const double l = length(image);
    return l > 0.0 ? Vec3f(image / l) : Vec3f();
}

// Puts a tangent at right angles to the shading normal that there is by now.
void setTangent(const Vec3f& tangent, Surface& surface) {
    const Vec3f& n = surface.shadingNormal;
    const Vec3f flat = tangent - n * dot(tangent, n);
    constexpr float kLeast = 1e-12f;  // squared; less is rounding's direction
    if (lengthSquared(flat) > kLeast) surface.tangent = normalize(flat);
}

// What heights change by along one axis of texture coordinates, from half a texel before a place to
// half a texel behind: the difference of neighbouring texels, which between their middles changes
// evenly.
double slopeAlong(float Vec2f::*axis, std::uint32_t texels, const TextureSource& textures,
                  const MaterialDescription& material, const TextureContext& at) {
    const float half = 0.5f / static_cast<float>(std::max(texels, 1u));
    TextureContext before = at, after = at;
    before.uv.*axis -= half;
    after.uv.*axis += half;
    // Not always a texel: far from 0 texture coordinates lie farther apart.
    const float way = after.uv.*axis - before.uv.*axis;
    if (!(way > 0.0f)) return 0.0;
    const float rise = textures.lookUp(material.bumpTexture, after).r -
                       textures.lookUp(material.bumpTexture, before).r;
    const double slope = static_cast<double>(rise) * static_cast<double>(material.bumpScale) /
                         static_cast<double>(way);
    return std::isfinite(slope) ? slope : 0.0;
}

}  // namespace

void Scene::prepareMaps(ShapeRecord& record, const InstanceDescription& instance,
                        const CancelCheck& cancel) {
    const auto any = [&](const auto& is) {
        return std::ranges::any_of(instance.materials,
                                   [&](std::uint32_t m) { return is(material(m)); });
    };
    const bool hasCoordinates = record.groups ? record.groups->hasTexcoords()
                                              : record.mesh && !record.mesh->texcoords.empty();
    if (!hasCoordinates) {
        if (any(hasReliefMap))
            m_notices.push_back(
                {NoticeCode::kNotCovered,
                 fmt::format("instance '{}' is no mesh with texture coordinates: the normal map or "
                             "bump map of its material is left out",
                             instance.name)});
        return;
    }
    record.hasMaps = any(hasReliefMap) || any(asksForTangents);
    if (record.mesh && any(asksForTangents)) record.tangents = Tangents::of(*record.mesh, cancel);
}

// The length of the normal as it is interpolated; 1 where there is none, or it is not used.
float Scene::smoothness(const Attributes& attributes, Vec2f barycentric, const Surface& surface) {
    if (!attributes.hasNormals || surface.shadingNormal == surface.geometricNormal) return 1.0f;
    return length(interpolated(attributes.normals, barycentric));
}

void Scene::applyMaps(const ShapeRecord& record, std::uint32_t primitive,
                      const Attributes& attributes, const TexturedEdges& edges, Vec2f barycentric,
                      const UvFootprint& footprint, Surface& surface) const {
    const MaterialDescription& material = m_materials[record.materialOf(primitive)];
    const bool needsTangent = asksForTangents(material);
    Vec3f tangent;
    if (needsTangent && record.groups) {
        tangent = interpolated(attributes.tangents, barycentric);
        const double size = length(Vec3d(tangent));
        if (size > 0) tangent = Vec3f(Vec3d(tangent) / size);
        surface.isTextureMirrored = attributes.isMirrored() != record.mirrored;
    } else if (needsTangent) {
        const Transform& transform = m_description.instances[surface.shape].transform;
        const Tangents& of = *record.tangents;
        const auto at = [&](std::size_t corner) {
            return moved(transform, of.at(primitive, corner));
        };
        tangent = interpolated({at(0), at(1), at(2)}, barycentric);
        surface.isTextureMirrored = of.isMirrored(primitive) != record.mirrored;
    }
    if (material.normalTexture != kNoTexture)
        turnByNormalMap(material, tangent, smoothness(attributes, barycentric, surface), footprint,
                        surface);
    if (material.bumpTexture != kNoTexture) turnByBumpMap(material, edges, footprint, surface);
    if (material.anisotropy > 0.0f) setTangent(tangent, surface);
}

void Scene::turnByNormalMap(const MaterialDescription& material, const Vec3f& tangent,
                            float normalLength, const UvFootprint& footprint,
                            Surface& surface) const {
    const Vec3f found = m_materials.textures->normalAt(material.normalTexture,
                                                       {surface.uv, surface.position, footprint});
    const Vec3f mapped{found.x * material.normalScale, found.y * material.normalScale, found.z};
    const TangentFrame frame =
        tangentFrame(tangent, surface.shadingNormal * normalLength, surface.isTextureMirrored);
    surface.shadingNormal =
        mappedNormal(surface.shadingNormal, surface.geometricNormal, frame, mapped);
}

void Scene::turnByBumpMap(const MaterialDescription& material, const TexturedEdges& edges,
                          const UvFootprint& footprint, Surface& surface) const {
    const TextureSource& textures = *m_materials.textures;
    const auto [across, down] = textures.texels(material.bumpTexture);
    const TextureContext at{surface.uv, surface.position, footprint};
    const HeightSlopes slopes{slopeAlong(&Vec2f::x, across, textures, material, at),
                              slopeAlong(&Vec2f::y, down, textures, material, at)};
    surface.shadingNormal =
        bumpedNormal(surface.shadingNormal, surface.geometricNormal, edges, slopes);
}

}  // namespace pm
