// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/scene/camera.h"

#include <cmath>
#include <variant>

#include "integrator/scene/scene.h"
#include "integrator/values/error.h"

namespace pm {

namespace {

// From within so many of the scene's radii rounding takes no more of a ray than of the scene.
constexpr double kNearRadii = 4.0;
// Of a difference that stands for a differential, whatever the camera's model.
constexpr double kPixelStep = 1.0 / 64;

const CameraDescription& cameraOf(const Scene& scene) {
    const auto& camera = scene.description().camera;
    if (!camera) throw Error(Status::kInvalidScene, "the scene has no camera");
    return *camera;
}

}  // namespace

Camera::Camera(const Scene& scene, std::int32_t width, std::int32_t height)
    : m_scene(scene),
      m_model(makeCameraModel(cameraOf(scene), 0.5 * height)),
      m_halfWidth(0.5 * width),
      m_halfHeight(0.5 * height),
      m_sceneRadius(scene.radius()) {
    const Transform& m = cameraOf(scene).cameraToWorld;
    for (const double v : m)
        if (!std::isfinite(v))
            throw Error(Status::kInvalidScene,
                        "the camera's transform has a value that is not finite");
    m_right = {m[0], m[4], m[8]};
    m_up = {m[1], m[5], m[9]};
    m_forward = -Vec3d{m[2], m[6], m[10]};
    if (!(length(m_right) > 0 && length(m_up) > 0 && length(m_forward) > 0))
        throw Error(Status::kInvalidScene, "the camera's transform is singular");
    m_right = normalize(m_right);
    m_up = normalize(m_up);
    m_forward = normalize(m_forward);
    m_eye = Vec3d{m[3], m[7], m[11]} - scene.centre();
    m_isFar = length(m_eye) > kNearRadii * m_sceneRadius;
    m_pixel = std::visit([](const auto& model) { return model.pixelWidth(); }, m_model);
}

Camera::Line Camera::lineThrough(const CameraSample& sample) const {
    CameraSample fromMiddle = sample;
    fromMiddle.x = sample.x - m_halfWidth;
    fromMiddle.y = m_halfHeight - sample.y;
    const CameraRay own =
        std::visit([&](const auto& model) { return model.ray(fromMiddle); }, m_model);
    const Vec3d direction =
        normalize(m_forward * own.direction.z + m_right * own.direction.x + m_up * own.direction.y);
    const Vec3d eye =
        m_eye + m_right * own.origin.x + m_up * own.origin.y + m_forward * own.origin.z;
    return {eye, direction};
}

Ray Camera::ray(const CameraSample& sample) const {
    const auto [eye, direction] = lineThrough(sample);
    Ray ray{Vec3f(eye), Vec3f(direction)};
    if (m_scene.hasCore()) ray = m_scene.rayFromAfar(eye, direction);
    ray.viewer = kCameraRays;
    ray.time = sample.time;
    if (m_scene.hasCore() || !m_isFar) return ray;
    // Entry into a sphere slightly larger than the scene's.
    const double radius = m_sceneRadius * 1.01;
    const double t = intersectSphere(eye, direction, 1e300, Vec3d(0.0), radius);
    if (t > 0) ray.origin = Vec3f(eye + direction * t);
    return ray;
}

RayFootprint Camera::footprint(const CameraSample& sample, const Ray& ray) const {
    RayFootprint footprint;
    if (!m_scene.filtersTextures()) return footprint;
    const Line own = lineThrough(sample);
    const double way = length(Vec3d(ray.origin) - own.from);
    const auto sideTo = [&](const Line& other) -> RayFootprint::Side {
        const Vec3d turn = (other.along - own.along) / kPixelStep;
        return {Vec3f((other.from - own.from) / kPixelStep + turn * way), Vec3f(turn)};
    };
    CameraSample right = sample, below = sample;
    right.x += kPixelStep;
    below.y += kPixelStep;
    footprint.x = sideTo(lineThrough(right));
    footprint.y = sideTo(lineThrough(below));
    footprint.isKnown = true;
    return footprint;
}

PixelBeam Camera::pixelBeam(const Ray& ray) const {
    const double way = m_isFar ? length(Vec3d(ray.origin) - m_eye) : 0.0;
    return {static_cast<float>(m_pixel.width + way * m_pixel.spread),
            static_cast<float>(m_pixel.spread)};
}

float Camera::depth(const Vec3f& position) const {
    return static_cast<float>(dot(Vec3d(position) - m_eye, m_forward));
}

}  // namespace pm
