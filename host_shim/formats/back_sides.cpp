// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "host_shim/formats/face_normal.h"
#include "host_shim/formats/lamps.h"

namespace pm::host {
namespace {

using Point = std::array<double, 3>;

// Whether every edge has two faces.
bool isClosed(const MeshData& mesh) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    edges.reserve(mesh.indices.size());
    std::size_t first = 0;
    for (const std::uint32_t size : mesh.faceSizes) {
        for (std::size_t i = 0; i < size; ++i)
            edges.push_back(
                std::minmax(mesh.indices[first + i], mesh.indices[first + (i + 1) % size]));
        first += size;
    }
    std::ranges::sort(edges);
    for (std::size_t i = 0; i < edges.size(); i += 2)
        if (i + 1 == edges.size() || edges[i] != edges[i + 1]) return false;
    return true;
}

// The faces of a mesh that emit from both sides, turned round and set back.
class BackSide {
  public:
    BackSide(const MeshData& mesh, const std::vector<std::uint32_t>& materials,
             const std::vector<bool>& isOfSlot)
        : m_mesh(mesh) {
        m_back.name = mesh.name;
        m_back.uvs = mesh.uvs;
        m_back.normals = mesh.normals;
        for (float& component : m_back.normals) component = -component;
        m_back.slotMaterials = materials;
        std::size_t first = 0;
        for (std::size_t face = 0; face < mesh.faceSizes.size(); ++face) {
            if (isOfSlot[mesh.faceSlots[face]]) addFace(face, first);
            first += mesh.faceSizes[face];
        }
    }

    bool isEmpty() const { return m_back.faceSizes.empty(); }

    MeshData take(double distance) {
        for (const auto& [vertex, local] : m_local) {
            const Point& normal = m_normals[local];
            const double length = std::hypot(normal[0], normal[1], normal[2]);
            const Point position = m_mesh.position(vertex);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double by = length > 0 ? distance * normal[axis] / length : 0;
                m_back.positions[3 * local + axis] = static_cast<float>(position[axis] - by);
            }
        }
        dropUnusedSlots();
        return std::move(m_back);
    }

  private:
    void addFace(std::size_t face, std::size_t first) {
        const std::uint32_t size = m_mesh.faceSizes[face];
        const Point normal = areaNormal(m_mesh, first, size);
        m_back.faceSizes.push_back(size);
        m_back.faceSlots.push_back(m_mesh.faceSlots[face]);
        for (std::size_t i = size; i-- > 0;) {
            const std::uint32_t vertex = m_mesh.indices[first + i];
            const auto [place, isNew] = m_local.try_emplace(vertex, m_normals.size());
            if (isNew) {
                m_normals.emplace_back();
                m_back.positions.resize(3 * m_normals.size());
            }
            for (std::size_t axis = 0; axis < 3; ++axis)
                m_normals[place->second][axis] += normal[axis];
            m_back.indices.push_back(static_cast<std::uint32_t>(place->second));
            if (!m_mesh.normalIndices.empty())
                m_back.normalIndices.push_back(m_mesh.normalIndices[first + i]);
            if (!m_mesh.uvIndices.empty()) m_back.uvIndices.push_back(m_mesh.uvIndices[first + i]);
        }
    }

    // A slot without a face would count as a material in use.
    void dropUnusedSlots() {
        std::vector<std::uint32_t> materials, newSlot(m_back.slotMaterials.size(), kNoIndex);
        for (std::uint32_t& slot : m_back.faceSlots) {
            if (newSlot[slot] == kNoIndex) {
                newSlot[slot] = static_cast<std::uint32_t>(materials.size());
                materials.push_back(m_back.slotMaterials[slot]);
            }
            slot = newSlot[slot];
        }
        m_back.slotMaterials = std::move(materials);
    }

    const MeshData& m_mesh;
    MeshData m_back;
    std::map<std::uint32_t, std::size_t> m_local;  // vertex of the mesh -> of the back
    std::vector<Point> m_normals;                  // of each vertex of the back, weighted by area
};

// None where a mesh with the materials of an instance has no back.
std::optional<MeshData> backOf(const SceneData& scene, const InstanceData& instance,
                               double distance) {
    const MeshData& mesh = scene.meshes[instance.index];
    const std::vector<std::uint32_t>& materials = scene.materialsOf(instance);
    std::vector<bool> isOfSlot;
    for (const std::uint32_t index : materials) {
        const MaterialData& material = scene.materials[index];
        isOfSlot.push_back(material.emits() && material.emitsFromBothSides);
    }
    if (std::ranges::find(isOfSlot, true) == isOfSlot.end() || mesh.tags || isClosed(mesh))
        return {};
    BackSide back(mesh, materials, isOfSlot);
    if (back.isEmpty()) return {};
    return back.take(distance);
}

}  // namespace

void addBackSides(SceneData& scene) {
    constexpr double kDistance = 2e-5;  // pairs of faces closer than 1e-5 can count as one
    double diagonal = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        diagonal = std::hypot(diagonal, scene.bounds.high[axis] - scene.bounds.low[axis]);
    // Of a mesh with these materials the number of its back; none where it has none.
    std::map<std::pair<std::uint32_t, std::vector<std::uint32_t>>, std::optional<std::uint32_t>>
        backs;
    const std::size_t count = scene.instances.size();
    for (std::size_t i = 0; i < count; ++i) {
        if (scene.instances[i].shape != InstanceData::Shape::kMesh) continue;
        InstanceData instance = scene.instances[i];
        const std::vector<std::uint32_t> materials = scene.materialsOf(instance);
        const auto [place, isNew] = backs.try_emplace({instance.index, materials});
        if (isNew) {
            auto back = backOf(scene, instance, kDistance * diagonal);
            if (back) {
                place->second = static_cast<std::uint32_t>(scene.meshes.size());
                scene.meshes.push_back(std::move(*back));
            }
        }
        if (!place->second) continue;
        instance.index = *place->second;
        instance.materials.clear();
        scene.instances.push_back(std::move(instance));
    }
}

}  // namespace pm::host
