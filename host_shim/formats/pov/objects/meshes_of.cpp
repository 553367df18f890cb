// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/pov/objects/meshes_of.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "host_shim/formats/pov/objects/camera_of.h"
#include "host_shim/values/host_error.h"

namespace pm::host::pov {
namespace {

using Vector = std::array<double, 3>;

std::vector<Vector> vectorsOf(const Node& node, std::size_t first = 0) {
    std::vector<Vector> vectors;
    for (std::size_t i = first; i < node.arguments.size(); ++i)
        if (const Numbers* const given = node.numbers(i)) {
            const Numbers v = given->promoted(3);
            vectors.push_back({v.at[0], v.at[1], v.at[2]});
        }
    return vectors;
}

void add(std::vector<float>& to, const Vector& point) {
    for (const double value : mirrored(point)) to.push_back(static_cast<float>(value));
}

// Corners run the other way round in a mirror.
void addFace(MeshData& mesh, const std::array<std::uint32_t, 3>& corners) {
    mesh.indices.insert(mesh.indices.end(), {corners[0], corners[2], corners[1]});
    mesh.faceSizes.push_back(3);
    mesh.faceSlots.push_back(0);
}

bool isDegenerate(const Vector& a, const Vector& b, const Vector& c) {
    return a == b || b == c || a == c;
}

void addTriangle(const Node& node, MeshData& mesh) {
    const std::vector<Vector> v = vectorsOf(node);
    const bool isSmooth = node.kind == "smooth_triangle";
    const std::size_t stride = isSmooth ? 2 : 1;
    if (v.size() < 3 * stride || isDegenerate(v[0], v[stride], v[2 * stride])) return;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size() / 3);
    // A mesh of both kinds has no normals where triangles are flat.
    if (isSmooth && mesh.normalIndices.size() < mesh.indices.size())
        mesh.normalIndices.resize(mesh.indices.size(), kNoIndex);
    const auto normal = static_cast<std::uint32_t>(mesh.normals.size() / 3);
    for (std::size_t corner = 0; corner < 3; ++corner) {
        add(mesh.positions, v[corner * stride]);
        if (isSmooth) add(mesh.normals, v[corner * stride + 1]);
    }
    addFace(mesh, {first, first + 1, first + 2});
    if (isSmooth)
        mesh.normalIndices.insert(mesh.normalIndices.end(), {normal, normal + 2, normal + 1});
}

void addMesh(const Node& node, MeshData& mesh) {
    for (const auto& item : node.items)
        if (item->kind == "triangle" || item->kind == "smooth_triangle") addTriangle(*item, mesh);
    if (!mesh.normalIndices.empty()) mesh.normalIndices.resize(mesh.indices.size(), kNoIndex);
}

// Three numbers of each list, which its count begins; textures' numbers stand between.
std::vector<std::array<std::uint32_t, 3>> indicesOf(const Node* list, std::size_t most) {
    std::vector<std::array<std::uint32_t, 3>> indices;
    if (list == nullptr) return indices;
    for (std::size_t i = 1; i < list->arguments.size(); ++i) {
        const Numbers* const given = list->numbers(i);
        if (given == nullptr || given->size < 3) continue;
        std::array<std::uint32_t, 3> of{};
        for (std::size_t corner = 0; corner < 3; ++corner) {
            if (!(given->at[corner] >= 0 && given->at[corner] < static_cast<double>(most)))
                throw HostError(
                    ExitCode::kBadInput,
                    fmt::format("{}: index {} of {}", list->place.text(), given->at[corner], most));
            of[corner] = static_cast<std::uint32_t>(given->at[corner]);
        }
        indices.push_back(of);
    }
    return indices;
}

void addMesh2(const Node& node, MeshData& mesh) {
    const Node *const vertices = node.find("vertex_vectors"), *const faces =
                                                                  node.find("face_indices");
    if (vertices == nullptr || faces == nullptr) return;
    for (const Vector& point : vectorsOf(*vertices, 1)) add(mesh.positions, point);
    const Node* const normals = node.find("normal_vectors");
    if (normals != nullptr)
        for (const Vector& normal : vectorsOf(*normals, 1)) add(mesh.normals, normal);
    const auto corners = indicesOf(faces, mesh.positions.size() / 3);
    for (const auto& face : corners) addFace(mesh, face);
    if (mesh.normals.empty()) return;
    auto ofNormals = indicesOf(node.find("normal_indices"), mesh.normals.size() / 3);
    if (ofNormals.empty() && mesh.normals.size() == mesh.positions.size()) ofNormals = corners;
    ofNormals.resize(corners.size(), {kNoIndex, kNoIndex, kNoIndex});
    for (const auto& face : ofNormals)
        mesh.normalIndices.insert(mesh.normalIndices.end(), {face[0], face[2], face[1]});
}

// A polygon's first point ends it; what follows are holes, which wait.
void addPolygon(const Node& node, MeshData& mesh) {
    const std::vector<Vector> points = vectorsOf(node, 1);
    const auto end =
        points.empty() ? points.end() : std::find(points.begin() + 1, points.end(), points.front());
    const auto count = static_cast<std::uint32_t>(end - points.begin());
    if (count < 3 || end + (end != points.end()) != points.end()) return;
    for (std::uint32_t i = 0; i < count; ++i) add(mesh.positions, points[i]);
    for (std::uint32_t i = count; i-- > 0;) mesh.indices.push_back(i);
    mesh.faceSizes.push_back(count);
    mesh.faceSlots.push_back(0);
}

// Cubic Bezier patches, by their u_steps and v_steps as a power of 2.
void addPatch(const Node& node, MeshData& mesh) {
    const std::vector<Vector> p = vectorsOf(node);
    if (p.size() < 16) return;
    const auto steps = [&node](std::string_view kind) {
        const Node* const item = node.find(kind);
        const double given = item && item->numbers(0) ? item->numbers(0)->at[0] : 3;
        return 1u << static_cast<unsigned>(std::clamp(given, 0.0, 7.0));
    };
    const std::uint32_t across = steps("u_steps"), down = steps("v_steps");
    const auto weights = [](double t) {
        const double s = 1 - t;
        return std::array<double, 4>{s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
    };
    for (std::uint32_t row = 0; row <= down; ++row)
        for (std::uint32_t column = 0; column <= across; ++column) {
            const auto v = weights(static_cast<double>(row) / down);
            const auto u = weights(static_cast<double>(column) / across);
            Vector point{};
            for (std::size_t i = 0; i < 16; ++i)
                for (std::size_t axis = 0; axis < 3; ++axis)
                    point[axis] += v[i / 4] * u[i % 4] * p[i][axis];
            add(mesh.positions, point);
        }
    for (std::uint32_t row = 0; row < down; ++row)
        for (std::uint32_t column = 0; column < across; ++column) {
            const std::uint32_t at = row * (across + 1) + column, below = at + across + 1;
            addFace(mesh, {at, at + 1, below});
            addFace(mesh, {below, at + 1, below + 1});
        }
}

}  // namespace

bool meshOf(const Node& node, MeshData& mesh) {
    if (node.kind == "triangle" || node.kind == "smooth_triangle")
        addTriangle(node, mesh);
    else if (node.kind == "mesh")
        addMesh(node, mesh);
    else if (node.kind == "mesh2")
        addMesh2(node, mesh);
    else if (node.kind == "polygon")
        addPolygon(node, mesh);
    else if (node.kind == "bicubic_patch")
        addPatch(node, mesh);
    return !mesh.faceSizes.empty();
}

}  // namespace pm::host::pov
