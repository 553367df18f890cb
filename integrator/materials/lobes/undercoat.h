// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "integrator/materials/lobes/lambertian.h"
#include "integrator/materials/lobes/layered.h"
#include "integrator/materials/lobes/sheen_albedo.h"

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
    GgxReflection lobe() const { return {{alpha}, {Fresnel::Curve::kSchlick, Rgb(f0)}}; }
};

// What lies over a diffuse lobe: the boundary of plastic, and a layer on top.
struct Cover {
    CoatAlbedo boundary;  // f0 0: there is none
    CoatAlbedo coat;      // a clear one
    float coatShare = 0.0f;
    float sheen = 0.0f;  // of fibres, in place of a coat: the largest channel
    float sheenRoughness = 1.0f;
    const LayerPass* pass = nullptr;  // of the layer, where both are

    bool isBoundaryAlone() const { return coatShare == 0.0f && sheen == 0.0f; }

    // Share of even light along a cosine that gets through all.
    float passes(float cosine) const {
        if (isBoundaryAlone()) return 1.0f - boundary.at(cosine);
        cosine = std::max(1e-4f, cosine);
        const float top = coatShare > 0.0f
                              ? coatShare * coat.at(cosine)
                              : sheen * SheenAlbedo::table().at(cosine, sheenRoughness);
        const float below = pass ? albedoBelow(boundary.lobe(), *pass, cosine).g : 0.0f;
        return std::max(0.0f, 1.0f - top - below);
    }
    // Its mean over directions, each by its cosine.
    float mean() const {
        if (isBoundaryAlone()) return 1.0f - boundary.mean();
        constexpr int kSteps = 24;
        return meanOverCosines([&](float cosine) { return passes(cosine); }, kSteps);
    }
};

// What a cover lets in from a direction, over its mean: by so much light from there counts more or
// less than in plain irradiance. As made, the same from everywhere.
struct Admission {
    Cover cover;
    float mean = 1.0f;

    bool isEven() const { return cover.boundary.f0 == 0.0f && cover.isBoundaryAlone(); }
    // cosine: to the shading normal.
    float from(float cosine) const {
        return isEven() ? 1.0f : cover.passes(std::clamp(cosine, 0.0f, 1.0f)) / mean;
    }
    // The same for covers of one material that are so alike that light kept for one serves the
    // other: textures may change a boundary's roughness and reflectance from place to place.
    std::uint32_t kind() const {
        constexpr float kSteps = 8.0f, kStepsOfF0 = 32.0f;
        const auto step = [](float v) { return static_cast<std::uint32_t>(v + 0.5f); };
        return step(kSteps * std::sqrt(cover.boundary.alpha)) << 8 |
               step(kStepsOfF0 * cover.boundary.f0);
    }
};

// Diffuse below layers that take what they reflect on the way in and on the way out: with
// w(mu) = 1 - what they reflect along mu, W its mean and rho the colour below,
// f = rho w(in) w(out) / (pi W). Of white all that they leave comes back, and the lobe is
// reciprocal. Its reflectance is rho w(out). Source: Kelemen & Szirmay-Kalos, "A Microfacet Based
// Coupled Specular-Matte BRDF Model", Eurographics 2001.
struct Undercoat {
    explicit Undercoat(const Cover& over = {}) : cover(over), mean(over.mean()) {}

    Cover cover;
    float mean;  // of what gets through it

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
        return cover.passes(std::clamp(dot(w, at.nd), 0.0f, 1.0f));
    }
    float fromEven(const LobePoint& at, const Vec3f& w) const { return passes(at, w) / mean; }
};

}  // namespace pm
