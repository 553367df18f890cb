// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/geometry/polygon_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "integrator/values/error.h"

namespace pm {
namespace {

constexpr const char* kChecking = "checking a mesh";

[[noreturn]] void reject(const std::string& text) {
    throw Error(Status::kInvalidScene, text);
}

void checkLimits(const PolygonMesh& mesh) {
    constexpr std::size_t kMax = std::numeric_limits<std::int32_t>::max();
    const std::size_t sizes[] = {mesh.positions.size(), mesh.vertexIndices.size(),
                                 mesh.normals.size(), mesh.texcoords.size()};
    for (const std::size_t size : sizes) {
        if (size > kMax)
            reject(fmt::format("a mesh array has {} entries of at most {}", size, kMax));
    }
}

void checkPositions(const PolygonMesh& mesh, const CancelCheck& cancel) {
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        cancel.throwIfSet(kChecking);
        const Vec3f& p = mesh.positions[i];
        if (isFinite(p) && maxAbsComponent(p) <= kMaxCoordinate) continue;
        reject(
            fmt::format("vertex {} is at ({}, {}, {}); coordinates must be finite and within +-{}",
                        i, p.x, p.y, p.z, kMaxCoordinate));
    }
    for (std::size_t i = 0; i < mesh.texcoords.size(); ++i) {
        cancel.throwIfSet(kChecking);
        const Vec2f& t = mesh.texcoords[i];
        if (std::isfinite(t.x) && std::isfinite(t.y)) continue;
        reject(fmt::format("texture coordinate {} is ({}, {}); it must be finite", i, t.x, t.y));
    }
}

std::size_t checkFaceSizes(const PolygonMesh& mesh) {
    std::size_t corners = 0;
    for (std::size_t face = 0; face < mesh.faceCount(); ++face) {
        const std::uint32_t size = mesh.faceVertexCounts[face];
        if (size < 3 || size > kMaxFaceSize) {
            reject(fmt::format("face {} has {} corners; it must have 3 to {}", face, size,
                               kMaxFaceSize));
        }
        corners += size;
    }
    return corners;
}

void checkArraySize(const char* name, std::size_t size, std::size_t expected, bool optional) {
    if (size == expected || (optional && size == 0)) return;
    reject(
        fmt::format("there are {} {}, but the faces have {} corners in all", size, name, expected));
}

void checkIndices(const PolygonMesh& mesh, const CancelCheck& cancel) {
    const auto vertexCount = static_cast<std::int64_t>(mesh.positions.size());
    const auto normalCount = static_cast<std::int64_t>(mesh.normals.size());
    const auto texcoordCount = static_cast<std::int64_t>(mesh.texcoords.size());
    const auto check = [](std::size_t face, const char* what, std::int64_t index,
                          std::int64_t least, std::int64_t count) {
        if (index >= least && index < count) return;
        reject(fmt::format("face {} refers to {} {} of {}", face, what, index, count));
    };
    std::size_t corner = 0;
    for (std::size_t face = 0; face < mesh.faceCount(); ++face) {
        cancel.throwIfSet(kChecking);
        for (std::uint32_t i = 0; i < mesh.faceVertexCounts[face]; ++i, ++corner) {
            check(face, "vertex", mesh.vertexIndices[corner], 0, vertexCount);
            if (!mesh.normalIndices.empty())
                check(face, "normal", mesh.normalIndices[corner], -1, normalCount);
            if (!mesh.texcoordIndices.empty())
                check(face, "texture coordinate", mesh.texcoordIndices[corner], -1, texcoordCount);
        }
    }
}

}  // namespace

void validate(const PolygonMesh& mesh, const CancelCheck& cancel) {
    checkLimits(mesh);
    checkPositions(mesh, cancel);
    const std::size_t corners = checkFaceSizes(mesh);
    checkArraySize("vertex indices", mesh.vertexIndices.size(), corners, false);
    checkArraySize("normal indices", mesh.normalIndices.size(), corners, true);
    checkArraySize("texture coordinate indices", mesh.texcoordIndices.size(), corners, true);
    if (!mesh.faceMaterials.empty() && mesh.faceMaterials.size() != mesh.faceCount()) {
        reject(fmt::format("there are {} material slots for {} faces", mesh.faceMaterials.size(),
                           mesh.faceCount()));
    }
    checkIndices(mesh, cancel);
}

bool isDegenerateTriangle(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const Vec3d ab = Vec3d(b) - Vec3d(a), ac = Vec3d(c) - Vec3d(a), bc = ac - ab;
    const double longestSquared =
        std::max({lengthSquared(ab), lengthSquared(ac), lengthSquared(bc)});
    const double doubleArea = length(cross(ab, ac));
    // The second bound keeps the squared length of the normal above the least float.
    constexpr double kLeastRatio = 1e-12, kLeastArea = 1e-18;
    return !(doubleArea > kLeastRatio * longestSquared && doubleArea > kLeastArea);
}

}  // namespace pm
