// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/scene_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace pm::host {
namespace {

using Point = std::array<double, 3>;

Transform translation(const Point& by) {
    return {1, 0, 0, by[0], 0, 1, 0, by[1], 0, 0, 1, by[2]};
}

bool isLit(const std::array<float, 3>& colour) {
    return colour[0] > 0 || colour[1] > 0 || colour[2] > 0;
}

}  // namespace

Transform product(const Transform& a, const Transform& b) {
    Transform result{};
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 4; ++column) {
            double sum = column == 3 ? a[row * 4 + 3] : 0.0;
            for (std::size_t i = 0; i < 3; ++i) sum += a[row * 4 + i] * b[i * 4 + column];
            result[row * 4 + column] = sum;
        }
    }
    return result;
}

Point transformed(const Transform& by, const Point& point) {
    Point result{};
    for (std::size_t row = 0; row < 3; ++row)
        result[row] = by[row * 4] * point[0] + by[row * 4 + 1] * point[1] +
                      by[row * 4 + 2] * point[2] + by[row * 4 + 3];
    return result;
}

double determinant(const Transform& of) {
    return of[0] * (of[5] * of[10] - of[6] * of[9]) - of[1] * (of[4] * of[10] - of[6] * of[8]) +
           of[2] * (of[4] * of[9] - of[5] * of[8]);
}

Bounds Bounds::nothing() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    return {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
}

void Bounds::add(const Point& point) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], point[axis]);
        high[axis] = std::max(high[axis], point[axis]);
    }
}

void Bounds::add(const Bounds& other) {
    add(other.low);
    add(other.high);
}

Bounds transformed(const Transform& by, const Bounds& box) {
    Bounds result = Bounds::nothing();
    for (unsigned corner = 0; corner < 8; ++corner) {
        Point at{};
        for (std::size_t axis = 0; axis < 3; ++axis)
            at[axis] = ((corner >> axis & 1) != 0 ? box.high : box.low)[axis];
        result.add(transformed(by, at));
    }
    return result;
}

void SceneData::placeEachMesh() {
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        InstanceData& instance = instances.emplace_back();
        instance.name = meshes[i].name;
        instance.index = static_cast<std::uint32_t>(i);
    }
}

const std::vector<std::uint32_t>& SceneData::materialsOf(const InstanceData& instance) const {
    const bool isOwn = instance.materials.empty() && instance.shape == InstanceData::Shape::kMesh;
    return isOwn ? meshes[instance.index].slotMaterials : instance.materials;
}

Transform SceneData::toWorld(const InstanceData& instance) const {
    const bool isMesh = instance.shape == InstanceData::Shape::kMesh;
    if (!isMesh) return instance.transform.value_or(kIdentity);
    // No arithmetic where nothing is moved: the picture's bits depend on these numbers.
    return instance.transform ? product(*instance.transform, translation(centre))
                              : translation(centre);
}

std::string withoutPicture(float missing) {
    if (missing == 0) return "it gives no light";
    return missing == 1 ? "its number is used alone"
                        : fmt::format("{:.3g} is taken in its place", missing);
}

bool SceneData::hasLight() const {
    if (sky && sky->strength > 0) return true;
    if (environment && isLit(environment->radiance)) return true;
    if (std::ranges::any_of(lights, [](const LightData& light) { return isLit(light.emission); }))
        return true;
    return std::ranges::any_of(instances, [this](const InstanceData& instance) {
        return std::ranges::any_of(materialsOf(instance), [this](std::uint32_t material) {
            return materials[material].emits();
        });
    });
}

}  // namespace pm::host
