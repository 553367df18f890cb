// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>

#include "integrator/materials/lobes/lobe.h"
#include "integrator/values/vec.h"

namespace pm {

// The correction for shading normals grows without bound at grazing angles; beyond this it is cut.
// Only photons that arrive within about so little of the horizon can lose something by it. What
// goes on is divided into photons of the mean flux (TracedPhoton), what lands is not.
inline constexpr float kLargestCorrection = 1000.0f, kLargestLanded = 20.0f;

inline float clamp01(float v) {
    return v > 0.0f ? std::min(v, 1.0f) : 0.0f;
}

// The mean over channels, by which lobes are chosen.
inline float meanChannel(const Rgb& c) {
    return (c.r + c.g + c.b) * (1.0f / 3.0f);
}

// A value of a lobe that reflects `whole` of even light, where its reflectance is to be another, as
// with the opacity.
inline Rgb inProportion(const Rgb& reflectance, const Rgb& whole, const Rgb& value) {
    const auto channel = [](float r, float w, float v) { return w > 0.0f ? r / w * v : 0.0f; };
    return {channel(reflectance.r, whole.r, value.r), channel(reflectance.g, whole.g, value.g),
            channel(reflectance.b, whole.b, value.b)};
}

// The mirror direction of `out`; all unit.
inline Vec3f reflect(const Vec3f& out, const Vec3f& normal) {
    return normalize(normal * (2.0f * dot(out, normal)) - out);
}

// Where a surface scatters, for light that leaves along `out` or, for photons, came from there: all
// that a lobe may know beside its own numbers. Directions are unit and point away from the surface.
struct LobePoint {
    // geometricNormal: out of the surface's front; shadingNormal: in its hemisphere.
    LobePoint(const Vec3f& out_, const Vec3f& geometricNormal, const Vec3f& shadingNormal,
              Transport transport_)
        : out(out_),
          ng(geometricNormal),
          ns(shadingNormal),
          isFront(dot(out, geometricNormal) >= 0.0f),
          transport(transport_) {
        if (!isFront) {
            ng = -ng;
            ns = -ns;
        }
        nd = ns;
        isBehindShading = dot(out, ns) <= 0.0f;
        if (isBehindShading) ns = ng;
    }

    // Whether `in` is on the side of `out` by the normals of lobes that ask where they are seen
    // from.
    bool isReflection(const Vec3f& in) const { return dot(in, ng) > 0.0f && dot(in, ns) > 0.0f; }

    // [Veach 1997, eq. 5.19]: what turns the radiance's BSDF into the photons' where the shading
    // normal is not the geometric one. In [0, 1000].
    float adjointCorrection(const Vec3f& in) const {
        if (transport == Transport::kRadiance) return 1.0f;
        const float numerator = std::abs(dot(out, ns) * dot(in, ng));
        const float denominator = std::abs(dot(out, ng) * dot(in, ns));
        return numerator >= kLargestCorrection * denominator ? kLargestCorrection
                                                             : numerator / denominator;
    }

    // Cosine of `out` to the shading normal over that to the geometric one, in [0, 20]: what a
    // photon that arrived from there counts for in irradiance.
    float normalRatio() const {
        const float shading = dot(out, nd), geometric = dot(out, ng);
        return shading >= kLargestLanded * geometric ? kLargestLanded
                                                     : std::max(0.0f, shading / geometric);
    }

    // To whose cosine the directions of diffuse lobes are drawn.
    const Vec3f& diffuseAxis() const { return transport == Transport::kPhotons ? ng : nd; }

    // Whether photons leave smooth surfaces by the ways of smooth_boundary.h.
    bool bendsPhotons() const { return transport == Transport::kPhotons && nd != ng; }

    Vec3f out;
    Vec3f ng;  // the geometric normal, turned to the side of `out`
    // Shading normals, turned likewise, of diffuse lobes and of all others. Seen from behind its
    // shading normal a surface would have no front to be a mirror with, so ns is ng there. What is
    // diffuse does not ask where it is seen from.
    Vec3f nd, ns;
    float opacity = 1.0f;  // share of the surface that is there, in [0, 1]
    // The radiance beyond that is seen straight on, and its factor 1 / eta^2; flux has eta^2.
    Rgb straight{};
    float straightEtaSquared = 1.0f;
    bool isFront;  // out is on the side of the surface's front
    bool isBehindShading;
    Transport transport;
};

}  // namespace pm
