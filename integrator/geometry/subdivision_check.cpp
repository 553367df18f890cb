// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "integrator/geometry/subdivision.h"
#include "integrator/values/error.h"

namespace pm {
namespace {

constexpr std::size_t kMaxValence = 65535;

[[noreturn]] void reject(const std::string& text) {
    throw Error(Status::kInvalidScene, text);
}

void checkSharpness(const std::string& where, float sharpness) {
    if (std::isfinite(sharpness) && sharpness >= 0) return;
    reject(fmt::format("{} has sharpness {}; it must be finite and >= 0 ({} is infinitely sharp)",
                       where, sharpness, kInfiniteSharpness));
}

void checkFeatures(const SubdivisionCage& cage) {
    const std::size_t vertexCount = cage.mesh.positions.size();
    for (std::size_t i = 0; i < cage.creases.size(); ++i) {
        for (const std::uint32_t vertex : cage.creases[i].vertices) {
            if (vertex >= vertexCount)
                reject(fmt::format("crease {} refers to vertex {} of {}", i, vertex, vertexCount));
        }
        checkSharpness(fmt::format("crease {}", i), cage.creases[i].sharpness);
    }
    for (std::size_t i = 0; i < cage.corners.size(); ++i) {
        if (cage.corners[i].vertex >= vertexCount) {
            reject(fmt::format("corner {} refers to vertex {} of {}", i, cage.corners[i].vertex,
                               vertexCount));
        }
        checkSharpness(fmt::format("corner {}", i), cage.corners[i].sharpness);
    }
    for (std::size_t i = 0; i < cage.holes.size(); ++i) {
        if (cage.holes[i] >= cage.mesh.faceCount()) {
            reject(fmt::format("hole {} refers to face {} of {}", i, cage.holes[i],
                               cage.mesh.faceCount()));
        }
    }
}

void checkScheme(const SubdivisionCage& cage) {
    if (cage.scheme != SubdivisionScheme::kLoop) return;
    for (std::size_t face = 0; face < cage.mesh.faceCount(); ++face) {
        const std::uint32_t size = cage.mesh.faceVertexCounts[face];
        if (size != 3)
            reject(fmt::format("face {} has {} corners; Loop subdivision wants triangles", face,
                               size));
    }
}

// Counts corners at each vertex; only where these are many does it look for the distinct edges,
// of which there are at most two for each corner.
void checkValence(const PolygonMesh& mesh) {
    std::vector<std::uint32_t> faces(mesh.positions.size(), 0);
    for (const std::uint32_t vertex : mesh.vertexIndices) ++faces[vertex];
    const auto most = std::max_element(faces.begin(), faces.end());
    if (most == faces.end() || *most <= kMaxValence / 2) return;

    for (std::uint32_t vertex = 0; vertex < faces.size(); ++vertex) {
        if (faces[vertex] <= kMaxValence / 2) continue;
        std::vector<std::uint32_t> neighbours;
        std::size_t first = 0;
        for (const std::uint32_t size : mesh.faceVertexCounts) {
            for (std::uint32_t i = 0; i < size; ++i) {
                if (mesh.vertexIndices[first + i] != vertex) continue;
                neighbours.push_back(mesh.vertexIndices[first + (i + 1) % size]);
                neighbours.push_back(mesh.vertexIndices[first + (i + size - 1) % size]);
            }
            first += size;
        }
        std::sort(neighbours.begin(), neighbours.end());
        const auto edges = static_cast<std::size_t>(
            std::unique(neighbours.begin(), neighbours.end()) - neighbours.begin());
        if (std::max<std::size_t>(edges, faces[vertex]) > kMaxValence) {
            reject(fmt::format("vertex {} has {} faces and {} edges; subdivision takes at most {}",
                               vertex, faces[vertex], edges, kMaxValence));
        }
    }
}

}  // namespace

void validate(const SubdivisionCage& cage) {
    // OpenSubdiv would print that.
    if (cage.mesh.faceCount() == 0)
        reject("the subdivision cage has no faces; it must have at least 1");
    validate(cage.mesh);
    checkFeatures(cage);
    checkScheme(cage);
    checkValence(cage.mesh);
}

}  // namespace pm
