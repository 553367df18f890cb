// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <tiny_obj_loader.h>

#include <cstdint>
#include <string>
#include <vector>

#include "host_shim/formats/obj/obj_text.h"
#include "host_shim/formats/scene_data.h"
#include "host_shim/formats/warnings.h"

namespace pm::host {

// Bounds of the vertices that faces refer to.
Bounds boundsOfFaces(const tinyobj::attrib_t& attributes,
                     const std::vector<tinyobj::shape_t>& shapes);

// Gathers what one group refers to into arrays of its own.
class MeshAssembly {
  public:
    // centre is subtracted from every position in double precision.
    MeshAssembly(const tinyobj::attrib_t& attributes, const std::array<double, 3>& centre);

    // faceSizes points at the sizes of this shape's faces. Materials below 0 become
    // defaultMaterial.
    MeshData assemble(const tinyobj::shape_t& shape, const std::uint32_t* faceSizes,
                      std::size_t faceCount, std::uint32_t defaultMaterial);
    // The vertex of the mesh assembled last that stands for a vertex of the file; kNoIndex if none.
    std::uint32_t localVertex(std::int64_t fileVertex) const;

  private:
    // Maps indices of the file to indices of one mesh, in the order they come.
    struct Renumbering {
        std::vector<std::uint32_t> local;  // of the file's index; kNoIndex = not met yet
        std::vector<std::uint32_t> met;
        std::uint32_t number(std::size_t index);
        void clear();
    };

    void copyAttributes(MeshData& mesh) const;
    std::uint32_t normalNumber(int index);

    const tinyobj::attrib_t& m_attributes;
    std::array<double, 3> m_centre;
    Renumbering m_vertices, m_normals, m_uvs;
};

}  // namespace pm::host
