// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/scene/camera/camera.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "integrator/scene/scene.h"
#include "integrator/values/error.h"

namespace pm {

namespace {

// From within so many of the scene's radii rounding takes no more of a ray than of the scene.
constexpr double kNearRadii = 4.0;

}  // namespace

Camera::Camera(const Scene& scene, std::int32_t width, std::int32_t height)
    : m_scene(scene),
      m_halfWidth(0.5 * width),
      m_halfHeight(0.5 * height),
      m_sceneRadius(scene.radius()) {
    const auto& camera = scene.description().camera;
    if (!camera) throw Error(Status::kInvalidScene, "the scene has no camera");
    const Transform& m = camera->cameraToWorld;
    for (const double v : m)
        if (!std::isfinite(v))
            throw Error(Status::kInvalidScene,
                        "the camera's transform has a value that is not finite");
    if (!(camera->verticalFieldOfView > 0 && camera->verticalFieldOfView < std::numbers::pi))
        throw Error(Status::kInvalidScene,
                    fmt::format("the camera's vertical field of view is {} radians; it must be "
                                "above 0 and below pi",
                                camera->verticalFieldOfView));
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
    // sin/cos of the half angle by the double-precision library would differ between processors in
    // the last bit of a double only; rounding the scale to float removes even that.
    m_scale = static_cast<double>(static_cast<float>(std::tan(0.5 * camera->verticalFieldOfView))) /
              m_halfHeight;
    m_aspect = camera->pixelAspect > 0 ? camera->pixelAspect : 1.0;
}

Ray Camera::ray(double x, double y) const {
    const Vec3d direction =
        normalize(m_forward + m_right * ((x - m_halfWidth) * m_scale * m_aspect) +
                  m_up * ((m_halfHeight - y) * m_scale));
    Ray ray{Vec3f(m_eye), Vec3f(direction)};
    if (m_scene.hasCore()) ray = m_scene.rayFromAfar(m_eye, direction);
    ray.viewer = kCameraRays;
    if (m_scene.hasCore() || !m_isFar) return ray;
    // Entry into a sphere slightly larger than the scene's.
    const double radius = m_sceneRadius * 1.01;
    const double t = intersectSphere(m_eye, direction, 1e300, Vec3d(0.0), radius);
    if (t > 0) ray.origin = Vec3f(m_eye + direction * t);
    return ray;
}

PixelBeam Camera::pixelBeam(const Ray& ray) const {
    const double way = m_isFar ? length(Vec3d(ray.origin) - m_eye) : 0.0;
    return {static_cast<float>(way * m_scale), static_cast<float>(m_scale)};
}

float Camera::depth(const Vec3f& position) const {
    return static_cast<float>(dot(Vec3d(position) - m_eye, m_forward));
}

}  // namespace pm
