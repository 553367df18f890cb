// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/look/framing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host_shim/formats/face_normal.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

using Point = std::array<double, 3>;

constexpr double kDefaultFovDegrees = 40.0;
constexpr double kMargin = 1.05;

Point minus(const Point& a, const Point& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double dot(const Point& a, const Point& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Point unit(const Point& a) {
    const double length = std::sqrt(dot(a, a));
    return {a[0] / length, a[1] / length, a[2] / length};
}

// A plate that stands along the view would be seen as a line: from 45 degrees above or beside it,
// with the ball around it in the picture.
Point eyeOfPlate(const Bounds& bounds, double fov, double aspect, bool fromNegativeZ) {
    const Point centre = bounds.centre();
    const Point size = minus(bounds.high, bounds.low);
    const double halfAngle = std::atan(std::tan(fov / 2) * std::min(1.0, aspect));
    const double distance = std::sqrt(dot(size, size)) / 2 / std::sin(halfAngle) * kMargin;
    const double step = distance / std::numbers::sqrt2;
    const bool lies = size[1] <= size[0];
    return {centre[0] + (lies ? 0 : step), centre[1] + (lies ? step : 0),
            centre[2] + (fromNegativeZ ? -step : step)};
}

// The nearest face of the bounds is the widest to be seen, so when it fits, all of them does.
Point defaultEye(const Bounds& bounds, double fov, double aspect, bool fromNegativeZ) {
    const Point centre = bounds.centre();
    const Point size = minus(bounds.high, bounds.low);
    constexpr double kFlat = 1e-4;  // of its depth
    const auto [thin, wide] = std::minmax(size[0], size[1]);
    if (thin <= kFlat * size[2] && wide > kFlat * size[2] && size[2] > 0)
        return eyeOfPlate(bounds, fov, aspect, fromNegativeZ);
    const double tangent = std::tan(fov / 2);
    double distance = std::max(size[1] / 2 / tangent, size[0] / 2 / (tangent * aspect)) * kMargin;
    if (!(distance > 0)) distance = size[2] > 0 ? size[2] : 1.0;
    return {centre[0], centre[1],
            fromNegativeZ ? bounds.low[2] - distance : bounds.high[2] + distance};
}

}  // namespace

LightData cameraLight(const CameraPose& camera, const Bounds& bounds) {
    double squaredDistance = 0;
    const auto centre = bounds.centre();
    for (std::size_t i = 0; i < 3; ++i) {
        squaredDistance += (camera.eye[i] - centre[i]) * (camera.eye[i] - centre[i]);
    }
    LightData light;
    light.name = "camera light";
    for (std::size_t axis = 0; axis < 3; ++axis) light.transform[axis * 4 + 3] = camera.eye[axis];
    const double intensity = 2 * (squaredDistance > 0 ? squaredDistance : 1.0);  // W/sr
    light.emission.fill(static_cast<float>(intensity));
    light.isInRenderingSpace = true;
    return light;
}

bool opensTowardsNegativeZ(const SceneData& scene) {
    constexpr double kNoticeable = 0.05;
    double towardsZ = 0, area = 0;
    for (const InstanceData& instance : scene.instances) {
        if (instance.shape != InstanceData::Shape::kMesh) continue;
        const MeshData& mesh = scene.meshes[instance.index];
        // Mirrored faces keep their fronts.
        const bool isMirrored = instance.transform && determinant(*instance.transform) < 0;
        std::size_t first = 0;
        for (const std::uint32_t size : mesh.faceSizes) {
            const Point n = areaNormal(mesh, first, size, instance.transform);
            towardsZ += isMirrored ? -n[2] : n[2];
            area += std::sqrt(dot(n, n));
            first += size;
        }
    }
    return towardsZ < -kNoticeable * area;
}

std::array<double, 3> eyeFrom(const std::array<double, 3>& direction, const Bounds& bounds,
                              double verticalFov, double aspect) {
    const Point centre = bounds.centre();
    const Point z = unit(direction);
    const Point x = unit(cross({0, 1, 0}, z));
    const Point y = cross(z, x);
    const double tangent = std::tan(verticalFov / 2) / kMargin;
    double distance = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        Point at{};
        for (std::size_t axis = 0; axis < 3; ++axis)
            at[axis] = ((corner >> axis & 1) != 0 ? bounds.high : bounds.low)[axis] - centre[axis];
        distance = std::max({distance, dot(at, z) + std::abs(dot(at, x)) / (tangent * aspect),
                             dot(at, z) + std::abs(dot(at, y)) / tangent});
    }
    if (!(distance > 0)) distance = 1;
    return {centre[0] + distance * z[0], centre[1] + distance * z[1], centre[2] + distance * z[2]};
}

// A point is in the picture where |x of it - x of the eye| is at most the tangent times its depth;
// so of all points the largest and the smallest of x plus and minus that decide, and y likewise.
ViewPoint viewOf(std::span<const Point> points, const Point& direction, double verticalFov,
                 double aspect) {
    const Point z = unit(direction);
    const Point x = unit(cross({0, 1, 0}, z));
    const Point y = cross(z, x);
    const double vertical = std::tan(verticalFov / 2) / kMargin;
    // Relative to the first, which costs no digits far from the origin.
    const Point& origin = points.front();
    double nearest = -std::numeric_limits<double>::infinity(), farthest = -nearest;
    double back = nearest;  // of the eye along z
    std::array<double, 2> middle{};
    for (const std::size_t side : {0u, 1u}) {
        const Point& across = side == 0 ? x : y;
        const double tangent = side == 0 ? vertical * aspect : vertical;
        double high = -std::numeric_limits<double>::infinity(), low = high;
        for (const Point& point : points) {
            const Point at = minus(point, origin);
            const double depth = dot(at, z);
            nearest = std::max(nearest, depth);
            farthest = std::min(farthest, depth);
            high = std::max(high, tangent * depth + dot(at, across));
            low = std::max(low, tangent * depth - dot(at, across));
        }
        middle[side] = (high - low) / 2;
        back = std::max(back, (high + low) / 2 / tangent);
    }
    if (!(back > nearest)) back = nearest + 1;  // of a single point
    const double target = farthest + (nearest - farthest) / 2;
    ViewPoint view;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double beside = origin[axis] + middle[0] * x[axis] + middle[1] * y[axis];
        view.eye[axis] = beside + back * z[axis];
        view.lookAt[axis] = beside + target * z[axis];
    }
    return view;
}

CameraPose frameCamera(const CameraOptions& options, const Bounds& bounds, double aspect) {
    CameraPose pose;
    pose.verticalFovDegrees = options.verticalFovDegrees.value_or(kDefaultFovDegrees);
    pose.verticalFov = pose.verticalFovDegrees * std::numbers::pi / 180;
    pose.lookAt = options.lookAt.value_or(bounds.centre());
    pose.eye = options.eye ? *options.eye
                           : defaultEye(bounds, pose.verticalFov, aspect, options.fromNegativeZ);
    const Point backward = minus(pose.eye, pose.lookAt);
    if (!(dot(backward, backward) > 0)) {
        throw HostError(ExitCode::kUsage,
                        fmt::format("--eye and --look-at are both {},{},{}; they must differ",
                                    pose.eye[0], pose.eye[1], pose.eye[2]));
    }
    const Point z = unit(backward);
    Point up = options.up.value_or(Point{0, 1, 0});
    pose.up = up;
    constexpr double kParallel = 1e-9;
    Point x = cross(up, z);
    if (!(dot(x, x) > kParallel * kParallel * dot(up, up))) {
        pose.upWasReplaced = true;
        up = std::abs(z[2]) < 0.9 ? Point{0, 0, 1} : Point{0, 1, 0};
        x = cross(up, z);
    }
    x = unit(x);
    const Point y = cross(z, x);
    for (std::size_t row = 0; row < 3; ++row) {
        pose.transform[row * 4 + 0] = x[row];
        pose.transform[row * 4 + 1] = y[row];
        pose.transform[row * 4 + 2] = z[row];
        pose.transform[row * 4 + 3] = pose.eye[row];
    }
    return pose;
}

std::optional<std::array<double, 3>> placeOf(const CameraData& camera) {
    if (!camera.transform) return camera.eye;
    const Transform& m = *camera.transform;
    return Point{m[3], m[7], m[11]};
}

CameraPose poseOf(const CameraData& camera, const CameraOptions& options, const Bounds& bounds,
                  double aspect) {
    CameraOptions all = options;
    if (!all.verticalFovDegrees) all.verticalFovDegrees = camera.verticalFovDegrees;
    const bool isMoved = options.eye || options.lookAt || options.up;
    const auto given = placeOf(camera);
    if (!all.eye) all.eye = given;
    std::optional<Point> lookAt = camera.lookAt, up = camera.up;
    if (camera.transform) {
        const Transform& m = *camera.transform;
        lookAt = minus(*given, {m[2], m[6], m[10]});
        up = Point{m[1], m[5], m[9]};
    }
    if (!all.lookAt) all.lookAt = lookAt;
    if (!all.up) all.up = up;
    CameraPose pose = frameCamera(all, bounds, aspect);
    // As it was given, to the last bit.
    if (camera.transform && !isMoved) pose.transform = *camera.transform;
    pose.lens = camera.lens;
    return pose;
}

}  // namespace pm::host
