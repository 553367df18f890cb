// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/materials/lobes/smooth_boundary.h"

#include <cmath>

namespace pm {

bool refractBy(const Vec3f& n, const Vec3f& out, float eta, Vec3f& direction) {
    const float cosine = dot(out, n);
    const float sin2Inside = (1.0f - cosine * cosine) / (eta * eta);
    if (sin2Inside >= 1.0f) return false;
    const float cosineInside = std::sqrt(1.0f - sin2Inside);
    direction = normalize(n * (cosine / eta - cosineInside) - out * (1.0f / eta));
    return true;
}

bool reflectOn(const LobePoint& at, BsdfSample& sample) {
    sample.direction = reflect(at.out, at.ns);
    if (dot(sample.direction, at.ng) <= 0.0f) sample.direction = reflect(at.out, at.ng);
    return true;
}

bool refractOn(const LobePoint& at, float eta, BsdfSample& sample) {
    // With the shading normal first, with the geometric one where that leads to the wrong side.
    for (const Vec3f& n : {at.ns, at.ng}) {
        if (!refractBy(n, at.out, eta, sample.direction)) continue;
        if (!(dot(sample.direction, at.ng) < 0.0f)) continue;
        // Radiance is squeezed into a narrower cone of a denser medium; flux is not changed.
        if (at.transport == Transport::kRadiance) sample.weight *= 1.0f / (eta * eta);
        sample.weight *= n == at.ns ? at.adjointCorrection(sample.direction) : 1.0f;
        return true;
    }
    return false;
}

PhotonWays reflectedWays(const LobePoint& at) {
    PhotonWays ways{};
    Vec3f &byShading = ways[0].direction, &byGeometric = ways[1].direction;
    byShading = reflect(at.out, at.nd);
    byGeometric = reflect(at.out, at.ng);
    ways[0].isOpen = dot(at.out, at.nd) > 0.0f && dot(byShading, at.ng) > 0.0f;
    ways[1].isOpen =
        dot(byGeometric, at.nd) <= 0.0f || dot(reflect(byGeometric, at.nd), at.ng) <= 0.0f;
    if (ways[0].isOpen) ways[0].correction = at.adjointCorrection(byShading);
    return ways;
}

PhotonWays refractedWays(const LobePoint& at, float eta) {
    PhotonWays ways{};
    Vec3f &byShading = ways[0].direction, &byGeometric = ways[1].direction;
    ways[0].isOpen = dot(at.out, at.nd) > 0.0f && refractBy(at.nd, at.out, eta, byShading) &&
                     dot(byShading, at.ng) < 0.0f;
    bool isSecond = refractBy(at.ng, at.out, eta, byGeometric);
    Vec3f back;
    if (isSecond && dot(byGeometric, at.nd) < 0.0f)
        isSecond = refractBy(-at.nd, byGeometric, 1.0f / eta, back) && dot(back, at.ng) <= 0.0f;
    ways[1].isOpen = isSecond;
    if (ways[0].isOpen) ways[0].correction = at.adjointCorrection(byShading);
    return ways;
}

float cosineSeenFrom(const LobePoint& at, const Vec3f& eye, bool isBeyond) {
    const float side = isBeyond ? -1.0f : 1.0f;
    const float shading = side * dot(eye, at.nd);
    return clamp01(shading > 0.0f ? shading : side * dot(eye, at.ng));
}

bool takeWay(const PhotonWays& ways, float u, BsdfSample& sample) {
    const float first = meanChannel(ways[0].share), second = meanChannel(ways[1].share);
    if (!(first + second > 0.0f)) return false;
    const float ofFirst = first / (first + second);
    const bool takesFirst = u < ofFirst;
    const PhotonWay& way = ways[takesFirst ? 0 : 1];
    sample.direction = way.direction;
    sample.weight = way.share * (way.correction /
                                 (sample.pdfSolidAngle * (takesFirst ? ofFirst : 1.0f - ofFirst)));
    return true;
}

}  // namespace pm
