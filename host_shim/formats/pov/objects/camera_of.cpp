// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/pov/objects/camera_of.h"

#include <cmath>
#include <numbers>

namespace pm::host::pov {
namespace {

using Vector = std::array<double, 3>;

double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
double length(const Vector& a) {
    return std::sqrt(dot(a, a));
}
Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vector scaled(const Vector& a, double by) {
    return {a[0] * by, a[1] * by, a[2] * by};
}
Vector ofLength(const Vector& a, double wanted) {
    const double is = length(a);
    return is > 0 ? scaled(a, wanted / is) : a;
}
Vector minus(const Vector& a, const Vector& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

// Turns the camera so that it sees a point in the middle, its right level with the sky; lengths
// and handedness stay.
void lookAt(PovCamera& camera, const Vector& point, const Vector& sky) {
    const Vector forward = minus(point, camera.location);
    if (!(length(forward) > 0)) return;
    const double hand = dot(cross(camera.up, camera.direction), camera.right);
    const Vector direction = ofLength(forward, 1);
    Vector right = cross(sky, direction);
    constexpr double kParallel = 1e-10;
    if (!(length(right) > kParallel)) right = {1, 0, 0};
    right = ofLength(right, 1);
    const Vector up = cross(direction, right);
    camera.direction = scaled(direction, length(camera.direction));
    camera.right = scaled(right, (hand < 0 ? -1 : 1) * length(camera.right));
    camera.up = scaled(up, length(camera.up));
}

void transform(PovCamera& camera, const Matrix& by) {
    Matrix linear = by;
    linear[3] = linear[7] = linear[11] = 0;
    camera.location = transformed(by, camera.location);
    camera.direction = transformed(linear, camera.direction);
    camera.right = transformed(linear, camera.right);
    camera.up = transformed(linear, camera.up);
}

std::optional<Vector> vectorOf(const Node* item) {
    if (item == nullptr || item->numbers(0) == nullptr) return std::nullopt;
    const Numbers v = item->numbers(0)->promoted(3);
    return Vector{v.at[0], v.at[1], v.at[2]};
}

}  // namespace

std::array<double, 3> mirrored(const std::array<double, 3>& point) {
    return {point[0], point[1], -point[2]};
}

Transform mirroredTransform(const Matrix& transform) {
    Transform result = transform;
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 4; ++column)
            if ((row == 2) != (column == 2)) result[row * 4 + column] = -result[row * 4 + column];
    return result;
}

double PovCamera::aspect() const {
    return length(right) / length(up);
}

PovCamera povCameraOf(const Node& node) {
    PovCamera camera;
    // One that was declared before, and what is changed of it.
    for (const Value& argument : node.arguments)
        if (const auto* const before = std::get_if<std::shared_ptr<const Node>>(&argument))
            camera = povCameraOf(**before);
    if (const auto v = vectorOf(node.find("location"))) camera.location = *v;
    if (const auto v = vectorOf(node.find("direction"))) camera.direction = *v;
    if (const auto v = vectorOf(node.find("right"))) camera.right = *v;
    if (const auto v = vectorOf(node.find("up"))) camera.up = *v;
    const Vector sky = vectorOf(node.find("sky")).value_or(Vector{0, 1, 0});
    if (const Node* const angle = node.find("angle"); angle && angle->numbers(0)) {
        const double half = angle->numbers(0)->at[0] * std::numbers::pi / 360;
        // Wider ones are of other projections.
        if (half > 0 && half < std::numbers::pi / 2)
            camera.direction =
                ofLength(camera.direction, length(camera.right) / 2 / std::tan(half));
    }
    if (const auto v = vectorOf(node.find("look_at"))) lookAt(camera, *v, sky);
    for (const auto& item : node.items)
        if (const auto by = transformOf(*item)) transform(camera, *by);
    return camera;
}

std::optional<CameraData> cameraOf(const PovCamera& camera,
                                   const std::array<std::int32_t, 2>& size) {
    const double along = length(camera.direction), across = length(camera.right),
                 high = length(camera.up);
    const double volume = std::abs(dot(cross(camera.up, camera.direction), camera.right));
    constexpr double kFlat = 1e-9;
    if (!(volume > kFlat * along * across * high)) return std::nullopt;
    // Our camera takes the directions of its axes, square to each other or not, and no lengths.
    const std::array<Vector, 4> columns{mirrored(camera.right), mirrored(camera.up),
                                        scaled(mirrored(camera.direction), -1),
                                        mirrored(camera.location)};
    CameraData data;
    data.transform.emplace();
    for (std::size_t column = 0; column < 4; ++column)
        for (std::size_t row = 0; row < 3; ++row)
            (*data.transform)[row * 4 + column] = columns[column][row];
    data.verticalFovDegrees = std::atan(high / 2 / along) * 360 / std::numbers::pi;
    data.lens.pixelAspect = across / high * size[1] / size[0];
    return data;
}

}  // namespace pm::host::pov
