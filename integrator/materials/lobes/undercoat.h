// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>

#include "integrator/materials/lobes/ggx_reflection.h"
#include "integrator/materials/lobes/lambertian.h"

namespace pm {

// What a coat reflects of even light, by the largest of its channels.
struct CoatAlbedo {
    float f0 = 0.0f;     // at normal incidence
    float alpha = 0.0f;  // 0: smooth

    float at(float cosine) const {
        if (alpha == 0.0f) return f0 + (1.0f - f0) * schlickWeight(cosine);
        return lobe().albedo(std::max(1e-4f, cosine)).g;
    }
    float mean() const { return alpha == 0.0f ? f0 + (1.0f - f0) / 21.0f : lobe().mean().g; }

  private:
    GgxReflection lobe() const { return {{alpha}, {Fresnel::Curve::kSchlick, Rgb(f0)}}; }
};

// Diffuse below a coat that takes what it reflects on the way in and on the way out: with
// w(mu) = 1 - what the coat reflects along mu, W its mean and rho the colour below,
// f = rho w(in) w(out) / (pi W). Of white all that the coat leaves comes back, and the lobe is
// reciprocal. Its reflectance is rho w(out). Source: Kelemen & Szirmay-Kalos, "A Microfacet Based
// Coupled Specular-Matte BRDF Model", Eurographics 2001.
struct Undercoat {
    CoatAlbedo coat;

    // What gets through it along `out`.
    float passesOut(const LobePoint& at) const { return passes(at, at.out); }

    static Rgb albedo(const LobePoint&, const Rgb& reflectance) { return reflectance; }
    float arrival(const LobePoint& at) const { return fromEven(at, at.out); }
    Rgb evaluate(const LobePoint& at, const Rgb& reflectance, const Vec3f& in) const {
        return Lambertian::evaluate(at, reflectance, in) * fromEven(at, in);
    }
    static float pdfSolidAngle(const LobePoint& at, const Vec3f& in, float choice) {
        return Lambertian::pdfSolidAngle(at, in, choice);
    }
    bool sample(const LobePoint& at, Vec2f u, BsdfSample& sample) const {
        const bool hasValue = Lambertian::sample(at, u, sample);
        sample.weight *= fromEven(at, sample.direction);
        return hasValue;
    }

  private:
    float passes(const LobePoint& at, const Vec3f& w) const {
        return 1.0f - coat.at(std::clamp(dot(w, at.nd), 0.0f, 1.0f));
    }
    float fromEven(const LobePoint& at, const Vec3f& w) const {
        return passes(at, w) / (1.0f - coat.mean());
    }
};

}  // namespace pm
