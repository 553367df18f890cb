// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <concepts>
#include <cstddef>
#include <optional>
#include <span>
#include <variant>

#include "integrator/lights/directional_light.h"
#include "integrator/lights/environment_light.h"
#include "integrator/lights/light_place.h"
#include "integrator/lights/light_sample.h"
#include "integrator/lights/point_light.h"
#include "integrator/lights/sphere_light.h"
#include "integrator/lights/spot_light.h"
#include "integrator/lights/surface_light.h"
#include "integrator/lights/triangle_light.h"

// The lists of all kinds of lights, and what each kind has to tell. A new kind is a file of its own
// and a line in LightKind, with what describes it a line in LightDescription. Whoever uses lights
// asks a Light.
namespace pm {

using LightKind = std::variant<TriangleLight, SphereLight, PointLight, SpotLight, DirectionalLight,
                               EnvironmentLight>;

// Lights that are described beside the shapes; an environment is by itself, since there is one at
// most. The order decides pictures, and checksums of scenes: a scene has its near lights kind after
// kind in this order, then those infinitely far. New kinds come last.
using LightDescription =
    std::variant<PointLightDescription, SpotLightDescription, DirectionalLightDescription>;

// Visits lights kind after kind, in the list's order, those of a kind as they come.
template <typename Visit>
void forEachByKind(std::span<const LightDescription> lights, const Visit& visit) {
    for (std::size_t kind = 0; kind < std::variant_size_v<LightDescription>; ++kind)
        for (const LightDescription& light : lights)
            if (light.index() == kind) std::visit(visit, light);
}

// A light that is met: where on it, see Light::sample(), and in which densities.
template <typename L>
concept SurfaceLightKind = std::derived_from<L, SurfaceLight> && L::kPlace ==
                           LightPlace::kOnSurface&& requires(const L light, const Scene& scene,
                                                             const Surface& surface, Vec2f u,
                                                             Vec3f direction, float probability,
                                                             LightSample& sample) {
    // See LightSampler::sample() and pdfSolidAngle(): times the probability of the light's choice.
    { light.sample(scene, surface, u, probability, sample) } -> std::same_as<bool>;
    { light.pdfSolidAngle(scene, surface, direction, surface, probability) } -> std::same_as<float>;
    { light.extent(scene) } -> std::same_as<LightExtent>;
    { light.ball(scene) } -> std::same_as<LightBall>;
    // The sphere all of which it is, if it is one: any of its directions is a point of it.
    { light.wholeSphere(scene) } -> std::same_as<std::optional<SphereShape>>;
};

// A light without area, by its falloff: the share of its largest intensity along a direction.
template <typename L>
concept PointLightKind = L::kPlace == LightPlace::kAtPoint&& requires(const L light, Vec2f u,
                                                                      Vec3f direction, Vec3d axis,
                                                                      double sine) {
    { light.position } -> std::same_as<const Vec3d&>;  // scene's own coordinates
    { light.intensity } -> std::same_as<const Rgb&>;   // the largest, W/sr
    { light.falloff(direction) } -> std::same_as<float>;
    // At most, in a cone around a unit axis with this sine of its half angle; may be an upper
    // bound.
    { light.largestFalloff(axis, sine) } -> std::same_as<float>;
    { light.falloffIntegral() } -> std::same_as<float>;  // over all directions, sr
    // Unit, with a density in proportion to the falloff.
    { light.sampleFalloff(u) } -> std::same_as<Vec3f>;
    { light.cone() } -> std::same_as<DirectionCone>;  // in which alone it shines
    { L::kIsEven } -> std::same_as<const bool&>;      // the falloff is 1 everywhere
    { light.extent() } -> std::same_as<LightExtent>;
};

// A light that is infinitely far.
template <typename L>
concept FarLightKind = L::kPlace == LightPlace::kFar&& requires(const L light, Vec2f u,
                                                                Vec3f direction, float probability,
                                                                ParallelLight& parallel) {
    { light.isMet() } -> std::same_as<bool>;  // by rays that meet nothing else
    // What is seen there; black of what isn't met. W m^-2 sr^-1.
    { light.radianceAlong(direction) } -> std::same_as<Rgb>;
    { light.look(u) } -> std::same_as<FarLook>;  // a direction, by what is seen there
    // Of look(), times the probability of the light's choice; 0 of what isn't met.
    { light.pdfSolidAngle(direction, probability) } -> std::same_as<float>;
    // See LightSampler::emitParallel().
    { light.emit(u, parallel) } -> std::same_as<bool>;
};

template <typename... Kinds>
constexpr bool areComplete(const std::variant<Kinds...>*) {
    return ((SurfaceLightKind<Kinds> || PointLightKind<Kinds> || FarLightKind<Kinds>)&&...);
}
static_assert(areComplete(static_cast<const LightKind*>(nullptr)));

}  // namespace pm
