// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cmath>

#include "integrator/materials/lobes/smooth_boundary.h"

namespace pm {

// Share of unpolarised light that a smooth boundary reflects. cosine: of the angle to the normal on
// the side the light comes from, in [0,1]; eta: index on the far side over this side's.
// Source: Fresnel's equations, averaged over both polarisations.
inline float fresnelDielectric(float cosine, float eta) {
    const float sin2Inside = (1.0f - cosine * cosine) / (eta * eta);
    if (sin2Inside >= 1.0f) return 1.0f;
    const float cosineInside = std::sqrt(1.0f - sin2Inside);
    const float parallel = (eta * cosine - cosineInside) / (eta * cosine + cosineInside);
    const float perpendicular = (cosine - eta * cosineInside) / (cosine + eta * cosineInside);
    return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

// A smooth boundary of glass or water.
struct Dielectric {
    Rgb tint;          // of what it lets through
    float eta = 1.0f;  // index on the far side over the index on this side

    SmoothShares shares(const LobePoint& at) const {
        if (sendsByWays(at))
            return {shareOf(ways(at, Lobe::kReflection)), shareOf(ways(at, Lobe::kRefraction))};
        const float reflected = fresnelDielectric(clamp01(dot(at.out, at.ns)), eta);
        return {Rgb(reflected * at.opacity), tint * ((1.0f - reflected) * at.opacity)};
    }
    static bool sendsByWays(const LobePoint& at) { return at.bendsPhotons(); }
    float etaSquared() const { return eta * eta; }

    bool sample(const LobePoint& at, float u, BsdfSample& sample) const {
        if (sendsByWays(at)) return takeWay(ways(at, sample.lobe), u, sample);
        return sample.lobe == Lobe::kReflection ? reflectOn(at, sample)
                                                : refractOn(at, eta, sample);
    }

  private:
    PhotonWays ways(const LobePoint& at, Lobe lobe) const {
        const bool isBeyond = lobe == Lobe::kRefraction;
        PhotonWays found = isBeyond ? refractedWays(at, eta) : reflectedWays(at);
        for (PhotonWay& way : found) {
            if (!way.isOpen) continue;
            const float reflected = fresnelDielectric(cosineSeenFrom(at, way.direction, isBeyond),
                                                      isBeyond ? 1.0f / eta : eta);
            way.share =
                isBeyond ? tint * ((1.0f - reflected) * at.opacity) : Rgb(reflected * at.opacity);
        }
        return found;
    }
};

}  // namespace pm
