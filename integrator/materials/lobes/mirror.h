// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/materials/lobes/fresnel.h"
#include "integrator/materials/lobes/smooth_boundary.h"

namespace pm {

// A smooth mirror.
struct Mirror {
    Fresnel fresnel;

    SmoothShares shares(const LobePoint& at) const {
        return {sendsByWays(at) ? shareOf(ways(at)) : shareSeenFrom(at, at.out), Rgb()};
    }
    static bool sendsByWays(const LobePoint& at) { return at.bendsPhotons(); }

    bool sample(const LobePoint& at, float u, BsdfSample& sample) const {
        if (sendsByWays(at)) return takeWay(ways(at), u, sample);
        return reflectOn(at, sample);
    }

  private:
    Rgb shareSeenFrom(const LobePoint& at, const Vec3f& eye) const {
        return fresnel.at(cosineSeenFrom(at, eye, false)) * at.opacity;
    }
    PhotonWays ways(const LobePoint& at) const {
        PhotonWays found = reflectedWays(at);
        for (PhotonWay& way : found)
            if (way.isOpen) way.share = shareSeenFrom(at, way.direction);
        return found;
    }
};

}  // namespace pm
