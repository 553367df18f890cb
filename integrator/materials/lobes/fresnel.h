// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cmath>
#include <cstdint>

#include "integrator/materials/lobes/lobe_point.h"

// Shares of unpolarised light that a boundary reflects: Fresnel's equations, averaged over both
// polarisations. cosine: of the angle to the normal on the side that the light comes from, in
// [0,1].
namespace pm {

// eta: index on the far side over this side's, > 0.
inline float fresnelDielectric(float cosine, float eta) {
    const float sin2Inside = (1.0f - cosine * cosine) / (eta * eta);
    if (sin2Inside >= 1.0f) return 1.0f;
    const float cosineInside = std::sqrt(1.0f - sin2Inside);
    const float parallel = (eta * cosine - cosineInside) / (eta * cosine + cosineInside);
    const float perpendicular = (cosine - eta * cosineInside) / (cosine + eta * cosineInside);
    return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

// A metal of index n - i k. Source: Born & Wolf, "Principles of Optics", section 14.2.
inline float fresnelConductor(float cosine, float n, float k) {
    const float c2 = cosine * cosine, s2 = 1.0f - c2;
    const float t0 = n * n - k * k - s2;
    const float a2b2 = std::sqrt(t0 * t0 + 4.0f * n * n * k * k);
    const float a = std::sqrt(std::fmax(0.0f, 0.5f * (a2b2 + t0)));
    const float t1 = a2b2 + c2, t2 = 2.0f * a * cosine;
    const float perpendicular = (t1 - t2) / (t1 + t2);
    const float t3 = c2 * a2b2 + s2 * s2, t4 = t2 * s2;
    const float parallel = perpendicular * (t3 - t4) / (t3 + t4);
    return 0.5f * (parallel + perpendicular);
}

// The index of a metal that reflects r in (0, 1) at normal incidence, and whose edge has the tint g
// in [0, 1]: n lies between its least and its greatest by g. Source: Gulbrandsen, "Artist Friendly
// Metallic Fresnel", JCGT 3(4), 2014, eqs. 12 to 14.
struct MetalIndex {
    float n, k;
};
inline MetalIndex metalOfEdge(float r, float g) {
    constexpr float kLeast = 1e-3f, kMost = 0.999f;
    r = std::fmin(std::fmax(r, kLeast), kMost);
    const float root = std::sqrt(r);
    const float n = g * (1.0f - r) / (1.0f + r) + (1.0f - g) * (1.0f + root) / (1.0f - root);
    const float k2 = (r * (n + 1.0f) * (n + 1.0f) - (n - 1.0f) * (n - 1.0f)) / (1.0f - r);
    return {n, std::sqrt(std::fmax(0.0f, k2))};
}

// Schlick 1994: from a reflectance at normal incidence to 1 at grazing angles.
inline float schlickWeight(float cosine) {
    const float m = 1.0f - cosine;
    return m * m * m * m * m;
}

// How the reflectance of a microfacet goes by the angle.
struct Fresnel {
    enum class Curve : std::uint8_t { kEven, kSchlick, kDielectric, kConductor };

    Curve curve = Curve::kEven;
    Rgb tint{1.0f};        // even: all of it; Schlick: at normal incidence; else a factor
    Rgb n{1.5f}, k{0.0f};  // relative to this side; of a dielectric n.r

    Rgb at(float cosine) const {
        switch (curve) {
            case Curve::kEven:
                return tint;
            case Curve::kSchlick:
                return tint + (Rgb(1.0f) - tint) * schlickWeight(cosine);
            case Curve::kDielectric:
                return tint * fresnelDielectric(cosine, n.r);
            case Curve::kConductor:
                return tint * Rgb(fresnelConductor(cosine, n.r, k.r),
                                  fresnelConductor(cosine, n.g, k.g),
                                  fresnelConductor(cosine, n.b, k.b));
        }
        return tint;
    }
    // The mean over directions, each by its cosine.
    Rgb mean() const {
        if (curve == Curve::kEven) return tint;
        if (curve == Curve::kSchlick) return tint + (Rgb(1.0f) - tint) * (1.0f / 21.0f);
        // Gauss-Legendre of four points for 2 F(mu) mu over [0, 1].
        constexpr float kAt[4] = {0.06943184f, 0.33000948f, 0.66999052f, 0.93056816f};
        constexpr float kWeight[4] = {0.17392742f, 0.32607258f, 0.32607258f, 0.17392742f};
        Rgb sum;
        for (int i = 0; i < 4; ++i) sum += at(kAt[i]) * (2.0f * kAt[i] * kWeight[i]);
        return sum;
    }
};

}  // namespace pm
