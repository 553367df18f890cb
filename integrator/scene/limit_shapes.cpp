// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/scene/limit_shapes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pm {

namespace {

// Of the picture's height: two pixels of a picture 1080 high. The size of the frame is not known
// here, and is not to change what is there.
constexpr double kPiecesOverHeight = 540;
// The picture's width over its height is not known either; wider ones are as coarse at their sides
// as what lies outside.
constexpr double kWidestPicture = 2.4;

// Where the surface has none, that of the triangle.
void fillNormals(TriangleMesh& mesh) {
    const TriangleMesh::Corners& triangle = mesh.triangles.back();
    for (std::uint32_t& index : mesh.normalIndices.back()) {
        if (!(mesh.normals[index] == Vec3f(0.0f))) continue;
        const Vec3d a(mesh.positions[triangle[0]]);
        const Vec3d out =
            cross(Vec3d(mesh.positions[triangle[1]]) - a, Vec3d(mesh.positions[triangle[2]]) - a);
        // Without area it is met by no ray.
        const double size = length(out);
        index = static_cast<std::uint32_t>(mesh.normals.size());
        mesh.normals.push_back(size > 0 ? Vec3f(out / size) : Vec3f(0.0f, 0.0f, 1.0f));
    }
}

void addGroup(TriangleMesh& mesh, const TriangleGroup& group, std::uint32_t slot, bool hasTexcoords,
              bool isMirrored) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size()),
               firstNormal = static_cast<std::uint32_t>(mesh.normals.size());
    for (const TriangleGroup::Point& point : group.points()) {
        mesh.positions.push_back(point.position);
        mesh.normals.push_back(point.normal);
        if (hasTexcoords) mesh.texcoords.push_back(point.texcoord);
    }
    for (std::uint32_t i = 0; i < group.triangleCount(); ++i) {
        auto [a, b, c] = group.cornersOf(i);
        if (isMirrored) std::swap(b, c);
        mesh.triangles.push_back({first + a, first + b, first + c});
        if (hasTexcoords) mesh.texcoordIndices.push_back(mesh.triangles.back());
        mesh.normalIndices.push_back({firstNormal + a, firstNormal + b, firstNormal + c});
        fillNormals(mesh);
        mesh.materials.push_back(slot);
    }
}

}  // namespace

TextureHeights::TextureHeights(const TextureSource& textures, const MaterialDescription& material,
                               const CancelCheck& cancel)
    : m_textures(textures),
      m_texture(material.displacementTexture),
      m_scale(material.displacementScale) {
    const auto [lo, hi] = textures.extremes(m_texture, cancel);
    m_range = {m_scale * static_cast<double>(lo), m_scale * static_cast<double>(hi)};
    if (m_range[0] > m_range[1]) std::swap(m_range[0], m_range[1]);
}

double TextureHeights::at(const std::array<double, 2>& texcoord) const {
    const Vec2f uv{static_cast<float>(texcoord[0]), static_cast<float>(texcoord[1])};
    const double height = m_scale * static_cast<double>(m_textures.lookUp(m_texture, {uv}).r);
    // What interpolation's roundings add.
    return std::clamp(height, m_range[0], m_range[1]);
}

TriangleMesh meshOf(const LimitGroups& groups, bool isMirrored, const CancelCheck& cancel) {
    TriangleMesh mesh;
    for (std::uint32_t group = 0; group < groups.groupCount(); ++group) {
        cancel.throwIfSet("tessellating");
        addGroup(mesh, *groups.make(group), groups.slot(group), groups.hasTexcoords(), isMirrored);
    }
    return mesh;
}

Box3d boxAround(const LimitShape& shape, const Transform& transform, double highest) {
    Box3d box;
    const PolygonMesh& mesh = shape.cage().mesh;
    for (const std::uint32_t vertex : mesh.vertexIndices) {
        const Vec3d p = transformPoint(transform, Vec3d(mesh.positions[vertex]));
        box.grow({p, p});
    }
    const Vec3d more(highest);
    return {box.lo - more, box.hi + more};
}

TessellationRule ruleOf(const SceneDescription& description, const InstanceDescription& instance,
                        const Vec3d& centre) {
    TessellationRule rule;
    rule.rate = static_cast<int>(instance.tessellationRate);
    if (!description.camera) return rule;
    const Transform& m = description.camera->cameraToWorld;
    const Vec3d forward{-m[2], -m[6], -m[10]};
    const double fieldOfView = description.camera->verticalFieldOfView;
    // What the camera itself refuses is told where it is made.
    if (!(length(forward) > 0) || !isFinite(forward) || !(fieldOfView > 0)) return rule;
    const double aspect = kWidestPicture * std::max(1.0, description.camera->pixelAspect);
    rule.viewpoint = {Vec3d{m[3], m[7], m[11]} - centre, normalize(forward),
                      std::atan(std::tan(0.5 * fieldOfView) * std::sqrt(1 + aspect * aspect)),
                      fieldOfView / kPiecesOverHeight};
    return rule;
}

}  // namespace pm
