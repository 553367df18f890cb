// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/lights/light.h"

#include <cmath>
#include <type_traits>
#include <utility>

namespace pm {

namespace {

// Asks a kind that shines from this place; the answer of others is empty.
template <LightPlace kPlace, typename Answer, typename Ask>
Answer answer(const LightKind& kind, const Ask& ask) {
    return std::visit(
        [&](const auto& light) -> Answer {
            if constexpr (std::decay_t<decltype(light)>::kPlace == kPlace)
                return ask(light);
            else
                return Answer{};
        },
        kind);
}
template <typename Answer, typename Ask>
Answer ofSurface(const LightKind& kind, const Ask& ask) {
    return answer<LightPlace::kOnSurface, Answer>(kind, ask);
}
template <typename Answer, typename Ask>
Answer ofPoint(const LightKind& kind, const Ask& ask) {
    return answer<LightPlace::kAtPoint, Answer>(kind, ask);
}
template <typename Answer, typename Ask>
Answer ofFar(const LightKind& kind, const Ask& ask) {
    return answer<LightPlace::kFar, Answer>(kind, ask);
}

template <typename Kind>
bool samplePoint(const Kind& light, const Surface& from, float probability, LightSample& sample) {
    const Vec3d toLight = light.position - Vec3d(from.position);
    const double d2 = lengthSquared(toLight);
    if (!(d2 > 0)) return false;
    sample.direction = Vec3f(toLight / std::sqrt(d2));
    sample.radiance = light.intensity * static_cast<float>(1 / d2);
    if constexpr (!Kind::kIsEven) {
        sample.radiance *= light.falloff(-sample.direction);
        if (isBlack(sample.radiance)) return false;
    }
    sample.pdfSolidAngle = probability;
    sample.isPoint = true;
    const Vec3f origin = rayOrigin(from, sample.direction);
    sample.shadowRay = {origin, Vec3f(light.position - Vec3d(origin)), 1.0f};
    return true;
}

}  // namespace

bool Light::isMet() const {
    return isOnSurface() || ofFar<bool>(m_kind, [](const auto& light) { return light.isMet(); });
}

bool Light::sample(const Scene& scene, const Surface& from, Vec2f u, float probability,
                   LightSample& sample) const {
    return std::visit(
        [&](const auto& light) {
            constexpr LightPlace kPlace = std::decay_t<decltype(light)>::kPlace;
            if constexpr (kPlace == LightPlace::kOnSurface)
                return light.sample(scene, from, u, probability, sample);
            else if constexpr (kPlace == LightPlace::kAtPoint)
                return samplePoint(light, from, probability, sample);
            else
                return sampleFar(light.look(u), from, probability, sample);
        },
        m_kind);
}

LightExtent Light::extent(const Scene& scene) const {
    if (isAtPoint())
        return ofPoint<LightExtent>(m_kind, [](const auto& light) { return light.extent(); });
    return ofSurface<LightExtent>(m_kind, [&](const auto& light) { return light.extent(scene); });
}

const SurfaceLight* Light::surface() const {
    return ofSurface<const SurfaceLight*>(
        m_kind, [](const SurfaceLight& light) -> const SurfaceLight* { return &light; });
}

SurfaceLight* Light::surface() {
    return const_cast<SurfaceLight*>(std::as_const(*this).surface());
}

float Light::pdfSolidAngle(const Scene& scene, const Surface& from, const Vec3f& direction,
                           const Surface& onLight, float probability) const {
    return ofSurface<float>(m_kind, [&](const auto& light) {
        return light.pdfSolidAngle(scene, from, direction, onLight, probability);
    });
}

LightBall Light::ball(const Scene& scene) const {
    return ofSurface<LightBall>(m_kind, [&](const auto& light) { return light.ball(scene); });
}

std::optional<SphereShape> Light::wholeSphere(const Scene& scene) const {
    return ofSurface<std::optional<SphereShape>>(
        m_kind, [&](const auto& light) { return light.wholeSphere(scene); });
}

Vec3d Light::position() const {
    return ofPoint<Vec3d>(m_kind, [](const auto& light) { return light.position; });
}

Rgb Light::intensity() const {
    return ofPoint<Rgb>(m_kind, [](const auto& light) { return light.intensity; });
}

float Light::falloff(const Vec3f& direction) const {
    return ofPoint<float>(m_kind, [&](const auto& light) { return light.falloff(direction); });
}

bool Light::isEven() const {
    return ofPoint<bool>(m_kind, [](const auto& light) { return light.kIsEven; });
}

float Light::largestFalloff(const Vec3d& axis, double sine) const {
    return ofPoint<float>(m_kind,
                          [&](const auto& light) { return light.largestFalloff(axis, sine); });
}

float Light::falloffIntegral() const {
    return ofPoint<float>(m_kind, [](const auto& light) { return light.falloffIntegral(); });
}

Vec3f Light::sampleFalloff(Vec2f u) const {
    return ofPoint<Vec3f>(m_kind, [&](const auto& light) { return light.sampleFalloff(u); });
}

DirectionCone Light::cone() const {
    return ofPoint<DirectionCone>(m_kind, [](const auto& light) { return light.cone(); });
}

Rgb Light::farRadiance(const Vec3f& direction) const {
    return ofFar<Rgb>(m_kind, [&](const auto& light) { return light.radianceAlong(direction); });
}

float Light::farPdfSolidAngle(const Vec3f& direction, float probability) const {
    return ofFar<float>(
        m_kind, [&](const auto& light) { return light.pdfSolidAngle(direction, probability); });
}

bool Light::emitParallel(Vec2f u, ParallelLight& parallel) const {
    return ofFar<bool>(m_kind, [&](const auto& light) { return light.emit(u, parallel); });
}

const Environment* Light::environment() const {
    const auto* const sky = std::get_if<EnvironmentLight>(&m_kind);
    return sky ? sky->environment : nullptr;
}

void addLights(std::span<const LightDescription> descriptions, bool far, const SceneBox& box,
               std::vector<Light>& lights) {
    forEachByKind(descriptions, [&](const auto& description) {
        using Kind = typename std::decay_t<decltype(description)>::Light;
        if ((Kind::kPlace == LightPlace::kFar) != far || description.isDark()) return;
        const Kind kind(description, box);
        lights.emplace_back(kind, kind.powerMean(description, box));
    });
}

}  // namespace pm
