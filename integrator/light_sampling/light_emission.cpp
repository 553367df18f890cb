// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// LightSampler: photons as they leave lights.
#include <cmath>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/lights/box_shadow.h"
#include "integrator/sampling/warps.h"

namespace pm {

void LightSampler::emissionCone(const Light& light, Vec3f& axis, float& oneMinusCos) const {
    axis = {0.0f, 0.0f, 1.0f};
    oneMinusCos = 2.0f;
    if (light.kind == Light::Kind::kSpot) {
        axis = m_scene.beam(light).axis;
        oneMinusCos = m_scene.beam(light).oneMinusCos;
    }
    const double r2 = m_scene.radius() * m_scene.radius() * 1.0001;
    const double d2 = lengthSquared(light.position);
    if (!(d2 > r2)) return;
    const float ofScene = oneMinusCosOfSphere(r2, d2);
    if (ofScene >= oneMinusCos) return;
    oneMinusCos = ofScene;
    axis = Vec3f(-light.position / std::sqrt(d2));
}

bool LightSampler::emitFromPoint(const Light& light, float probability, Vec2f u,
                                 EmittedPhoton& photon) const {
    Vec3f axis;
    float oneMinusCos, pdf;
    emissionCone(light, axis, oneMinusCos);
    photon.ray.origin = Vec3f(light.position);
    photon.flux = light.intensity * (1.0f / probability);
    if (light.kind == Light::Kind::kSpot) {
        const Beam& beam = m_scene.beam(light);
        if (oneMinusCos == beam.oneMinusCos) {
            photon.ray.direction = beam.sampleIntensity(u, pdf);
            photon.flux *= beam.fluxOverIntensity();
            return true;
        }
    }
    photon.ray.direction = normalize(Frame(axis).toWorld(sampleUniformCone(u, oneMinusCos)));
    photon.flux *= 2.0f * kPi * oneMinusCos;
    if (light.kind == Light::Kind::kSpot)
        photon.flux *= m_scene.beam(light).intensity(photon.ray.direction);
    return !isBlack(photon.flux);
}

bool LightSampler::emitParallel(const Light& light, Vec2f u, ParallelLight& parallel) const {
    if (light.kind == Light::Kind::kEnvironment) {
        float pdf;
        const Vec3f seen = m_scene.environment().sample(u, pdf);
        parallel = {-seen, m_scene.environment().radiance(seen) * (1.0f / pdf)};
        return !isBlack(parallel.irradiance);
    }
    const Beam& beam = m_scene.beam(light);
    parallel = {beam.axis, light.intensity};
    if (beam.isDelta()) return true;
    parallel.direction =
        normalize(Frame(beam.axis).toWorld(sampleUniformCone(u, beam.oneMinusCos)));
    parallel.irradiance *= 2.0f * kPi * beam.oneMinusCos;
    return true;
}

Ray LightSampler::parallelRay(const Vec3d& through, const Vec3f& direction) const {
    // A point of the scene's box is within its radius of the centre.
    const Vec3d start = through - Vec3d(direction) * (2.1 * m_scene.radius());
    if (m_scene.hasCore()) return m_scene.rayFromAfar(start, Vec3d(direction));
    return {Vec3f(start), direction};
}

bool LightSampler::emitFromAfar(const Light& light, float probability, Vec2f uPoint,
                                Vec2f uDirection, EmittedPhoton& photon) const {
    ParallelLight parallel;
    if (!emitParallel(light, uDirection, parallel)) return false;
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
    const Surface point = m_scene.pointOnLight(light, uPoint, density);
    return emitFrom({point.position, point.offset, point.geometricNormal}, frontRadiance(point),
                    light.area / density);
}

}  // namespace pm
