// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/shapes/smooth_point.h"

#include "integrator/scene/scene.h"
#include "integrator/scene/shape_record.h"

namespace pm {

namespace {

// Of the point of a triangle's plane that is nearest.
std::array<double, 3> barycentricsOf(const Vec3d& fromVertex, const Vec3d& e1, const Vec3d& e2) {
    const double a = dot(e1, e1), b = dot(e1, e2), c = dot(e2, e2);
    const double p = dot(fromVertex, e1), q = dot(fromVertex, e2);
    const double determinant = a * c - b * b;
    if (!(determinant > 0.0)) return {1.0 / 3, 1.0 / 3, 1.0 / 3};
    const double b1 = std::clamp((p * c - q * b) / determinant, 0.0, 1.0);
    const double b2 = std::clamp((q * a - p * b) / determinant, 0.0, 1.0 - b1);
    return {1.0 - b1 - b2, b1, b2};
}

}  // namespace

bool Scene::smoothPoint(const Surface& surface, const Vec3f& side, SmoothPoint& smooth) const {
    const ShapeRecord& record = m_shapes[surface.shape];
    if (!record.mesh || record.mesh->normals.empty()) return false;
    const auto& triangle = record.mesh->triangles[surface.primitive];
    const auto& at = record.mesh->normalIndices[surface.primitive];
    const std::array<Vec3d, 3> vertices = {record.vertex(triangle[0]), record.vertex(triangle[1]),
                                           record.vertex(triangle[2])};
    std::array<Vec3f, 3> normals = {record.normal(at[0]), record.normal(at[1]),
                                    record.normal(at[2])};
    const bool isTurned = dot(normals[0] + normals[1] + normals[2], side) < 0.0f;
    const std::array<double, 3> b =
        barycentricsOf(Vec3d(surface.position) - vertices[0], vertices[1] - vertices[0],
                       vertices[2] - vertices[0]);
    Vec3d normal;
    for (std::size_t i = 0; i < 3; ++i) {
        if (isTurned) normals[i] = -normals[i];
        normal += Vec3d(normals[i]) * b[i];
    }
    const double size = length(normal);
    if (!(size > 1e-6)) return false;
    smooth = {liftedPoint(vertices, normals, b), Vec3f(normal / size)};
    return true;
}

}  // namespace pm
