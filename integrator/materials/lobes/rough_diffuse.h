// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "integrator/materials/lobes/lambertian.h"

namespace pm {

// Diffuse, as plaster and clay are: rough facets send light back to where it came from, and what is
// scattered between them is kept. Reciprocal; of white all comes back. Its reflectance is rho,
// times the opacity. Source: Portsmouth, Kutz & Hill, "EON: A practical energy-preserving rough
// diffuse BRDF", JCGT 14(1), 2025; its first part is Fujii's form of Oren & Nayar 1994.
struct RoughDiffuse {
    float roughness = 0.5f;  // [0, 1]; 0: Lambertian
    Rgb rho{1.0f};           // without the opacity

    Rgb albedo(const LobePoint& at, const Rgb& reflectance) const {
        const float once = reflects(cosine(at, at.out));
        return perReflectance(reflectance,
                              [&](float r) { return r * once + ofMore(r) * (1.0f - once); });
    }
    // Maps know no directions: what is sent back to the light alone is spread evenly of them.
    float arrival(const LobePoint& at) const {
        const float r = meanChannel(rho), once = reflects(cosine(at, at.out));
        const float mean = r * meanReflected() + ofMore(r) * (1.0f - meanReflected());
        return mean > 0.0f ? (r * once + ofMore(r) * (1.0f - once)) / mean : 1.0f;
    }
    Rgb evaluate(const LobePoint& at, const Rgb& reflectance, const Vec3f& in) const {
        return Lambertian::evaluate(at, colour(at, reflectance, in), in);
    }
    static float pdfSolidAngle(const LobePoint& at, const Vec3f& in, float choice) {
        return Lambertian::pdfSolidAngle(at, in, choice);
    }
    bool sample(const LobePoint& at, Vec2f u, BsdfSample& sample) const {
        const bool hasValue = Lambertian::sample(at, u, sample);
        sample.weight = colour(at, sample.weight, sample.direction);
        return hasValue;
    }

  private:
    static float cosine(const LobePoint& at, const Vec3f& w) {
        return std::clamp(dot(w, at.nd), 1e-4f, 1.0f);
    }
    float scale() const {
        constexpr float kPi3 = 2.0f / (3.0f * std::numbers::pi_v<float>);
        return 1.0f / (1.0f + (0.5f - kPi3) * roughness);
    }
    // Of even white light along a cosine, in one scattering.
    float reflects(float mu) const {
        const float s = std::sqrt(std::max(0.0f, 1.0f - mu * mu));
        const auto theta = static_cast<float>(2.0 * std::numbers::pi * pinnedAtan2Turns(s, mu));
        const float g = s * (theta - s * mu) + (2.0f / 3.0f) * ((s / mu) * (1.0f - s * s * s) - s);
        return scale() * (1.0f + roughness * g * kInvPi);
    }
    float meanReflected() const {
        constexpr float kOfRoughness = 2.0f / 3.0f - 28.0f / (15.0f * std::numbers::pi_v<float>);
        return scale() * (1.0f + kOfRoughness * roughness);
    }
    // Of light that is scattered more than once.
    float ofMore(float r) const {
        return r * r * meanReflected() / (1.0f - r * (1.0f - meanReflected()));
    }
    // f(rho) of each channel, for a multiple of rho.
    template <typename F>
    Rgb perReflectance(const Rgb& multiple, const F& f) const {
        const auto channel = [&](float m, float r) { return r > 0.0f ? m / r * f(r) : 0.0f; };
        return {channel(multiple.r, rho.r), channel(multiple.g, rho.g), channel(multiple.b, rho.b)};
    }
    // What stands in place of a Lambertian's reflectance.
    Rgb colour(const LobePoint& at, const Rgb& multiple, const Vec3f& in) const {
        const float o = cosine(at, at.out), i = cosine(at, in);
        const float s = dot(at.out, in) - dot(at.out, at.nd) * dot(in, at.nd);
        const float back = s > 0.0f ? s / std::max(o, i) : s;
        const float once = scale() * (1.0f + roughness * back);
        const float missing = 1.0f - meanReflected();
        const float more =
            missing > 0.0f ? (1.0f - reflects(o)) * (1.0f - reflects(i)) / missing : 0.0f;
        return perReflectance(multiple, [&](float r) { return r * once + ofMore(r) * more; });
    }
};

}  // namespace pm
