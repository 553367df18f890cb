// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/face_normal.h"

namespace pm::host {

std::array<double, 3> areaNormal(const MeshData& mesh, std::size_t first, std::size_t size,
                                 const std::optional<Transform>& transform) {
    using Point = std::array<double, 3>;
    const auto corner = [&](std::size_t i) {
        const Point local = mesh.position(mesh.indices[first + i]);
        return transform ? transformed(*transform, local) : local;
    };
    Point normal{};
    for (std::size_t i = 0; i < size; ++i) {
        const Point a = corner(i), b = corner((i + 1) % size);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t y = (axis + 1) % 3, z = (axis + 2) % 3;
            normal[axis] += (a[y] - b[y]) * (a[z] + b[z]);
        }
    }
    return normal;
}

}  // namespace pm::host
