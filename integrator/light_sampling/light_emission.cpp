// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// LightSampler: photons as they leave lights.
#include <cmath>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/lights/box_shadow.h"
#include "integrator/sampling/warps.h"

namespace pm {

DirectionCone LightSampler::emissionCone(const Light& light) const {
    const DirectionCone own = light.cone();
    const Vec3d position = light.position();
    const double r2 = m_scene.radius() * m_scene.radius() * 1.0001;
    const double d2 = lengthSquared(position);
    if (!(d2 > r2)) return own;
    const float ofScene = oneMinusCosOfSphere(r2, d2);
    if (ofScene >= own.oneMinusCos) return own;
    return {Vec3f(-position / std::sqrt(d2)), ofScene};
}

bool LightSampler::emitFromPoint(const Light& light, float probability, Vec2f u,
                                 EmittedPhoton& photon) const {
    photon.isMet = false;
    const DirectionCone cone = emissionCone(light);
    photon.ray.origin = Vec3f(light.position());
    photon.flux = light.intensity() * (1.0f / probability);
    if (cone.oneMinusCos == light.cone().oneMinusCos) {
        photon.ray.direction = light.sampleFalloff(u);
        photon.flux *= light.falloffIntegral();
        return !isBlack(photon.flux);
    }
    photon.ray.direction =
        normalize(Frame(cone.axis).toWorld(sampleUniformCone(u, cone.oneMinusCos)));
    photon.flux *= 2.0f * kPi * cone.oneMinusCos;
    photon.flux *= light.falloff(photon.ray.direction);
    return !isBlack(photon.flux);
}

Ray LightSampler::parallelRay(const Vec3d& through, const Vec3f& direction) const {
    // A point of the scene's box is within its radius of the centre.
    const Vec3d start = through - Vec3d(direction) * (2.1 * m_scene.radius());
    if (m_scene.hasCore()) return m_scene.rayFromAfar(start, Vec3d(direction));
    return {Vec3f(start), direction};
}

bool LightSampler::emitFromAfar(const Light& light, float probability, Vec2f uPoint,
                                Vec2f uDirection, EmittedPhoton& photon) const {
    photon.isMet = light.isMet();
    ParallelLight parallel;
    if (!light.emitParallel(uDirection, parallel)) return false;
    const BoxShadow scene(m_scene.halfSize(), Vec3d(parallel.direction));
    const double area = scene.area();
    if (!(area > 0)) return false;
    photon.ray = parallelRay(scene.sample(uPoint), parallel.direction);
    photon.flux = parallel.irradiance * (static_cast<float>(area) / probability);
    return !isBlack(photon.flux);
}

bool LightSampler::emit(float uLight, Vec2f uPoint, Vec2f uDirection, EmittedPhoton& photon) const {
    if (empty()) return false;
    float probability;
    const std::size_t index = m_choice.choose(uLight, probability);
    photon.light = static_cast<std::uint32_t>(index);
    const LampTriangle& lamp = m_scene.lampTriangle(index);
    // Area density 1/A and direction density cos/pi leave the radiance times pi A.
    const auto emitFrom = [&](const LampPoint& point, const Rgb& radiance, float area) {
        const Frame frame(point.normal);
        photon.ray = {point.position + point.normal * point.offset,
                      frame.toWorld(sampleCosineHemisphere(uDirection))};
        photon.flux = radiance * (kPi * area / probability);
        return !isBlack(photon.flux);
    };
    if (lamp)
        return emitFrom(lamp.point(uPoint), m_scene.material(lamp.material).emission, lamp.area);
    const Light& light = m_scene.lights()[index];
    if (light.isAtPoint()) return emitFromPoint(light, probability, uDirection, photon);
    if (light.isFar()) return emitFromAfar(light, probability, uPoint, uDirection, photon);
    float density;
    const SurfaceLight& shining = *light.surface();
    const Surface point = m_scene.pointOnLight(shining, uPoint, density);
    return emitFrom(LampPoint(point), frontRadiance(point), shining.area / density);
}

}  // namespace pm
