// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/lamps.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

namespace pm::host {
namespace {

using Point = std::array<double, 3>;

Point difference(const MeshData& mesh, std::uint32_t to, std::uint32_t from) {
    const Point a = mesh.position(to), b = mesh.position(from);
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

double lengthSquared(const Point& p) {
    return p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
}

// Whether any triangle from the first corner has more area than rounding makes.
bool hasArea(const MeshData& mesh, std::size_t firstCorner, std::uint32_t size) {
    constexpr double kRounding = 1e-12;
    const std::uint32_t* const corners = mesh.indices.data() + firstCorner;
    for (std::uint32_t i = 1; i + 1 < size; ++i) {
        const Point a = difference(mesh, corners[i], corners[0]);
        const Point b = difference(mesh, corners[i + 1], corners[0]);
        const Point normal{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                           a[0] * b[1] - a[1] * b[0]};
        const double longest = std::max(lengthSquared(a), lengthSquared(b));
        if (std::sqrt(lengthSquared(normal)) > kRounding * longest) return true;
    }
    return false;
}

}  // namespace

void warnOfLampsWithoutArea(const SceneData& scene, const std::string& sceneName,
                            const WarningSink& warn) {
    std::set<std::pair<std::uint32_t, std::vector<std::uint32_t>>> told;
    for (const InstanceData& instance : scene.instances) {
        if (instance.shape != InstanceData::Shape::kMesh) continue;
        const MeshData& mesh = scene.meshes[instance.index];
        const std::vector<std::uint32_t>& materials = scene.materialsOf(instance);
        if (!told.emplace(instance.index, materials).second) continue;
        const auto emits = [&](std::uint32_t slot) {
            return scene.materials[materials[slot]].emits();
        };
        std::vector<bool> slotHasArea(mesh.slotMaterials.size());
        std::size_t corner = 0;
        for (std::size_t face = 0; face < mesh.faceSizes.size(); ++face) {
            const std::uint32_t slot = mesh.faceSlots[face];
            if (!slotHasArea[slot] && emits(slot))
                slotHasArea[slot] = hasArea(mesh, corner, mesh.faceSizes[face]);
            corner += mesh.faceSizes[face];
        }
        for (std::uint32_t slot = 0; slot < slotHasArea.size(); ++slot) {
            if (slotHasArea[slot] || !emits(slot)) continue;
            warn(Warning::kGeometry,
                 fmt::format("{}: group {}: the faces of material {} have no area, so this lamp "
                             "gives no light",
                             sceneName, mesh.name.empty() ? "without a name" : mesh.name,
                             scene.materials[materials[slot]].name));
        }
    }
}

}  // namespace pm::host
