// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Answers of a scene to its lights, see SurfaceLight.
#include "integrator/lights/surface_light.h"
#include "integrator/scene/scene.h"

namespace pm {

SphereShape sphereOf(const Scene& scene, const SurfaceLight& light) {
    return scene.sphere(light.shape);
}

Surface pointOnLight(const Scene& scene, const SurfaceLight& light, Vec2f u) {
    return scene.pointOnLight(light, u);
}

Surface pointOnLight(const Scene& scene, const SurfaceLight& light, Vec2f u, float& density) {
    return scene.pointOnLight(light, u, density);
}

Surface pointOnSphere(const Scene& scene, const SurfaceLight& light, const Vec3d& direction) {
    return scene.pointOnSphere(light.shape, direction);
}

float densityOnLight(const Scene& scene, const SurfaceLight& light, const Surface& point) {
    return scene.lampDensity(light, point);
}

Rgb frontRadiance(const Scene& scene, const Surface& point) {
    return scene.emission(point.material, point.uv);
}

}  // namespace pm
