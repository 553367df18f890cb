// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/shapes/ray_footprint.h"

#include <algorithm>

#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// Seen more edge-on than this a footprint grows no longer: far beyond what any filter tells apart.
constexpr float kLeastCosine = 1e-4f;
// Near the critical angle directions change without bound; a footprint this wide is as good as one.
constexpr float kWidestDirection = 1.0f;
// Of the directions that a sample by a lobe stands for, those that its cone covers, as a side: the
// lobe's other samples cover the rest. A cosine lobe's samples get about kWidest.
constexpr float kSideOfSample = 0.05f;

Vec3f bounded(const Vec3f& change) {
    const float squared = lengthSquared(change);
    if (squared <= kWidestDirection * kWidestDirection) return change;
    // Also of what is not finite.
    return squared < 1e30f ? change * (kWidestDirection / std::sqrt(squared)) : Vec3f(0.0f);
}

}  // namespace

RayFootprint RayFootprint::cone(const Vec3f& direction, float spread, float width) {
    RayFootprint footprint;
    const Frame frame(direction);
    footprint.x = {frame.tangent * width, frame.tangent * spread};
    footprint.y = {frame.bitangent * width, frame.bitangent * spread};
    footprint.isKnown = footprint.isWide = true;
    return footprint;
}

float RayFootprint::width() const {
    return std::sqrt(std::min(lengthSquared(x.origin), lengthSquared(y.origin)));
}

void RayFootprint::arrive(const Ray& ray, const Vec3f& position, const Vec3f& normal) {
    const float way = length(position - ray.origin);
    const float cosine = dot(ray.direction, normal);
    const float towards = std::copysign(std::max(std::abs(cosine), kLeastCosine), cosine);
    for (Side* const side : {&x, &y}) {
        const Vec3f across = side->origin + side->direction * way;
        side->origin = across - ray.direction * (dot(across, normal) / towards);
        side->normal = Vec3f(0.0f);
    }
}

void RayFootprint::reflect(const Vec3f& in, const Vec3f& normal, bool turned) {
    const float cosine = -dot(in, normal);
    for (Side* const side : {&x, &y}) {
        const Vec3f bend = turned ? -side->normal : side->normal;
        const float change = -dot(side->direction, normal) - dot(in, bend);
        side->direction =
            bounded(side->direction + normal * (2.0f * change) + bend * (2.0f * cosine));
    }
}

// The direction is in / eta + normal (cosine / eta - cosineBeyond); its change by the chain rule.
void RayFootprint::refract(const Vec3f& in, const Vec3f& normal, bool turned, float eta) {
    const float ratio = 1.0f / eta;
    const float cosine = -dot(in, normal);
    const float cosineBeyond =
        std::sqrt(std::max(0.0f, 1.0f - ratio * ratio * (1.0f - cosine * cosine)));
    const float along = ratio * cosine - cosineBeyond;
    for (Side* const side : {&x, &y}) {
        const Vec3f bend = turned ? -side->normal : side->normal;
        const float change = -dot(side->direction, normal) - dot(in, bend);
        const float alongChange =
            (ratio - ratio * ratio * cosine / std::max(cosineBeyond, kLeastCosine)) * change;
        side->direction = bounded(side->direction * ratio + normal * alongChange + bend * along);
    }
}

void RayFootprint::widen(const Vec3f& direction, float pdfSolidAngle) {
    const float before =
        std::sqrt(std::max(lengthSquared(x.direction), lengthSquared(y.direction)));
    const float ofLobe = pdfSolidAngle > 0.0f ? kSideOfSample / std::sqrt(pdfSolidAngle) : kWidest;
    *this = cone(direction, std::min(kWidest, std::max(before, ofLobe)), width());
}

}  // namespace pm
