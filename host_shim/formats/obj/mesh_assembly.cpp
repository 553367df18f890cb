// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/obj/mesh_assembly.h"

#include <algorithm>
#include <limits>
#include <map>

namespace pm::host {

Bounds boundsOfFaces(const tinyobj::attrib_t& attributes,
                     const std::vector<tinyobj::shape_t>& shapes) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Bounds bounds{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
    for (const tinyobj::shape_t& shape : shapes) {
        for (const tinyobj::index_t& index : shape.mesh.indices) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double value =
                    attributes.vertices[static_cast<std::size_t>(index.vertex_index) * 3 + axis];
                bounds.low[axis] = std::min(bounds.low[axis], value);
                bounds.high[axis] = std::max(bounds.high[axis], value);
            }
        }
    }
    return bounds;
}

std::uint32_t MeshAssembly::Renumbering::number(std::size_t index) {
    if (local[index] == kNoIndex) {
        local[index] = static_cast<std::uint32_t>(met.size());
        met.push_back(static_cast<std::uint32_t>(index));
    }
    return local[index];
}

void MeshAssembly::Renumbering::clear() {
    for (const std::uint32_t index : met) local[index] = kNoIndex;
    met.clear();
}

MeshAssembly::MeshAssembly(const tinyobj::attrib_t& attributes, const std::array<double, 3>& centre)
    : m_attributes(attributes), m_centre(centre) {
    m_vertices.local.assign(attributes.vertices.size() / 3, kNoIndex);
    m_normals.local.assign(attributes.normals.size() / 3, kNoIndex);
    m_uvs.local.assign(attributes.texcoords.size() / 2, kNoIndex);
}

std::uint32_t MeshAssembly::localVertex(std::int64_t fileVertex) const {
    if (fileVertex < 0 || fileVertex >= static_cast<std::int64_t>(m_vertices.local.size())) {
        return kNoIndex;
    }
    return m_vertices.local[static_cast<std::size_t>(fileVertex)];
}

// A normal of length 0 is no normal.
std::uint32_t MeshAssembly::normalNumber(int index) {
    if (index < 0) return kNoIndex;
    const std::size_t at = static_cast<std::size_t>(index);
    const auto* normal = &m_attributes.normals[at * 3];
    if (normal[0] == 0 && normal[1] == 0 && normal[2] == 0) return kNoIndex;
    return m_normals.number(at);
}

MeshData MeshAssembly::assemble(const tinyobj::shape_t& shape, const std::uint32_t* faceSizes,
                                std::size_t faceCount, std::uint32_t defaultMaterial) {
    m_vertices.clear();
    m_normals.clear();
    m_uvs.clear();
    MeshData mesh;
    mesh.name = shape.name;
    mesh.faceSizes.assign(faceSizes, faceSizes + faceCount);
    for (const tinyobj::index_t& index : shape.mesh.indices) {
        mesh.indices.push_back(m_vertices.number(static_cast<std::size_t>(index.vertex_index)));
        mesh.normalIndices.push_back(normalNumber(index.normal_index));
        mesh.uvIndices.push_back(index.texcoord_index < 0 ? kNoIndex
                                                          : m_uvs.number(static_cast<std::size_t>(
                                                                index.texcoord_index)));
    }
    std::map<std::uint32_t, std::uint32_t> slots;
    for (const int id : shape.mesh.material_ids) {
        const std::uint32_t material = id < 0 ? defaultMaterial : static_cast<std::uint32_t>(id);
        const auto [slot, isNew] =
            slots.try_emplace(material, static_cast<std::uint32_t>(mesh.slotMaterials.size()));
        if (isNew) mesh.slotMaterials.push_back(material);
        mesh.faceSlots.push_back(slot->second);
    }
    copyAttributes(mesh);
    return mesh;
}

void MeshAssembly::copyAttributes(MeshData& mesh) const {
    for (const std::size_t vertex : m_vertices.met) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            mesh.positions.push_back(
                static_cast<float>(m_attributes.vertices[vertex * 3 + axis] - m_centre[axis]));
        }
    }
    for (const std::size_t normal : m_normals.met) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            mesh.normals.push_back(static_cast<float>(m_attributes.normals[normal * 3 + axis]));
        }
    }
    for (const std::size_t uv : m_uvs.met) {
        mesh.uvs.push_back(static_cast<float>(m_attributes.texcoords[uv * 2]));
        mesh.uvs.push_back(static_cast<float>(m_attributes.texcoords[uv * 2 + 1]));
    }
    if (mesh.normals.empty()) mesh.normalIndices.clear();
    if (mesh.uvs.empty()) mesh.uvIndices.clear();
}

}  // namespace pm::host
