// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/materials/lobes/fresnel.h"
#include "integrator/materials/lobes/smooth_boundary.h"

namespace pm {

// A smooth boundary of glass or water.
struct Dielectric {
    Rgb tint;                             // of what it lets through
    float eta = 1.0f;                     // index on the far side over the index on this side
    PhotonWays reflected{}, refracted{};  // of photons, which shares() finds

    // Keeps the photons' ways: they take as long to find as all else, and sample() wants them.
    SmoothShares shares(const LobePoint& at) {
        if (sendsByWays(at)) {
            reflected = ways(at, Lobe::kReflection);
            refracted = ways(at, Lobe::kRefraction);
            return {shareOf(reflected), shareOf(refracted)};
        }
        const float share = fresnelDielectric(clamp01(dot(at.out, at.ns)), eta);
        return {Rgb(share * at.opacity), tint * ((1.0f - share) * at.opacity)};
    }
    static bool sendsByWays(const LobePoint& at) { return at.bendsPhotons(); }

    bool sample(const LobePoint& at, float u, BsdfSample& sample) const {
        if (sample.lobe == Lobe::kRefraction) sample.etaSquared = eta * eta;
        if (sendsByWays(at))
            return takeWay(sample.lobe == Lobe::kReflection ? reflected : refracted, u, sample);
        return sample.lobe == Lobe::kReflection ? reflectOn(at, sample)
                                                : refractOn(at, eta, sample);
    }

  private:
    PhotonWays ways(const LobePoint& at, Lobe lobe) const {
        const bool isBeyond = lobe == Lobe::kRefraction;
        PhotonWays found = isBeyond ? refractedWays(at, eta) : reflectedWays(at);
        for (PhotonWay& way : found) {
            if (!way.isOpen) continue;
            const float share = fresnelDielectric(cosineSeenFrom(at, way.direction, isBeyond),
                                                  isBeyond ? 1.0f / eta : eta);
            way.share = isBeyond ? tint * ((1.0f - share) * at.opacity) : Rgb(share * at.opacity);
        }
        return found;
    }
};

}  // namespace pm
