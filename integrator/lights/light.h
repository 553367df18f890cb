// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "integrator/lights/light_kinds.h"

namespace pm {

// One light of a scene, of any kind. Only this knows which kinds there are: everyone else asks what
// he wants to know, by where the light shines from. Scene's own coordinates; directions are unit.
// Threads: const functions from any, at once.
class Light {
  public:
    // powerMean: see below.
    template <typename Kind>
    Light(const Kind& kind, double powerOfIt)
        : powerMean(powerOfIt), m_kind(kind), m_place(Kind::kPlace) {}

    // W, mean of the channels, never 0 of a surface; of what is infinitely far, what enters the
    // scene's box.
    double powerMean;

    bool isOnSurface() const { return m_place == LightPlace::kOnSurface; }
    bool isAtPoint() const { return m_place == LightPlace::kAtPoint; }
    bool isFar() const { return m_place == LightPlace::kFar; }
    // Whether rays can meet it: it has an area, a disc in the sky, or is all of the sky.
    bool isMet() const;

    // A point on it, or a direction to it, as seen from a surface. probability: of its choice,
    // which is multiplied into the sample's density. False when that can't shine on the surface.
    bool sample(const Scene& scene, const Surface& from, Vec2f u, float probability,
                LightSample& sample) const;
    // Of a near light: its bounds.
    LightExtent extent(const Scene& scene) const;

    // Of a light on a surface; null of others.
    const SurfaceLight* surface() const;
    SurfaceLight* surface();
    // Density of sample() for the point `onLight` along a direction, times the probability; sr^-1.
    float pdfSolidAngle(const Scene& scene, const Surface& from, const Vec3f& direction,
                        const Surface& onLight, float probability) const;
    LightBall ball(const Scene& scene) const;
    // The sphere all of which shines; nothing where it is another shape.
    std::optional<SphereShape> wholeSphere(const Scene& scene) const;

    // Of a light at a point. Intensity: the largest, W/sr; falloff: its share along a direction.
    Vec3d position() const;
    Rgb intensity() const;
    float falloff(const Vec3f& direction) const;
    // The falloff is 1 everywhere.
    bool isEven() const;
    // At most, in a cone around the axis with this sine of its half angle.
    float largestFalloff(const Vec3d& axis, double sine) const;
    // Over all directions, sr.
    float falloffIntegral() const;
    // A direction with a density in proportion to the falloff.
    Vec3f sampleFalloff(Vec2f u) const;
    // Directions in which alone it shines.
    DirectionCone cone() const;

    // Of a far light: radiance that is seen along a direction where nothing is in the way; black of
    // parallel light. W m^-2 sr^-1.
    Rgb farRadiance(const Vec3f& direction) const;
    // Density of sample(), times the probability, sr^-1; 0 of parallel light.
    float farPdfSolidAngle(const Vec3f& direction, float probability) const;
    // A direction in which it shines, by what comes from there. False when that is nothing.
    bool emitParallel(Vec2f u, ParallelLight& parallel) const;
    // Null where it isn't the light of an environment.
    const Environment* environment() const;

  private:
    LightKind m_kind;
    LightPlace m_place;
};

// Adds described lights of which rays meet none before all shapes (far) or the others, black ones
// left out; in the order of LightDescription's kinds.
void addLights(std::span<const LightDescription> descriptions, bool far, const SceneBox& box,
               std::vector<Light>& lights);

}  // namespace pm
