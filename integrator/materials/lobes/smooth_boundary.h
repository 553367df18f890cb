// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>

#include "integrator/materials/lobes/lobe_point.h"

namespace pm {

// How light goes on at a mirror or glass: in one direction, by one of the two normals. Lobes that
// are smooth share it.

// What such a lobe reflects and lets through.
struct SmoothShares {
    Rgb reflected, refracted;
};

// Where light from `out`, on the side of n, goes beyond it; eta: index there over that here. False
// where it is all reflected.
bool refractBy(const Vec3f& n, const Vec3f& out, float eta, Vec3f& direction);

// The camera's way, and the photons' where both normals are one. sample: as a smooth lobe gets it
// (lobes.h); eta: index on the far side over this side's.
bool reflectOn(const LobePoint& at, BsdfSample& sample);
bool refractOn(const LobePoint& at, float eta, BsdfSample& sample);

// The camera goes by the shading normal, and by the geometric one where it sees the surface from
// behind the other or would come out on the wrong side. So a photon has no, one or two ways on:
// those from whose ends the camera comes to where the photon is from.
struct PhotonWay {
    Vec3f direction;
    float correction = 1.0f;
    bool isOpen = false;
    Rgb share{};  // of the light there that the camera gets
};
// By the shading normal and by the geometric one.
using PhotonWays = std::array<PhotonWay, 2>;

// Without their shares, which are the lobe's business. eta: index on the far side over this side's.
PhotonWays reflectedWays(const LobePoint& at);
PhotonWays refractedWays(const LobePoint& at, float eta);

// The cosine by which a camera sees the surface from `eye`, on the side of `out` or beyond.
float cosineSeenFrom(const LobePoint& at, const Vec3f& eye, bool isBeyond);

// Of both together.
inline Rgb shareOf(const PhotonWays& ways) {
    return ways[0].share + ways[1].share;
}

// One of them by chance. u: in [0, 1). False: there is none.
bool takeWay(const PhotonWays& ways, float u, BsdfSample& sample);

}  // namespace pm
