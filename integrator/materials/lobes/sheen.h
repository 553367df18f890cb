// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>

#include "integrator/materials/lobes/local_reflection.h"
#include "integrator/materials/lobes/sheen_albedo.h"
#include "integrator/sampling/pinned_math.h"

namespace pm {

inline constexpr float kLeastSheenRoughness = 0.07f;

// Fibres that stand on a surface, as of velvet. Source: Estevez & Kulla, "Production Friendly
// Microfacet Sheen BRDF", SIGGRAPH 2017 course, its distribution of normals with the shadowing of
// Neubelt & Pettineo 2013. Where that would reflect more than comes in, all of that roughness is
// less.
struct Sheen {
    float roughness = 0.3f;  // [kLeastSheenRoughness, 1]
    Rgb tint{1.0f};

    Rgb albedo(float cosine) const { return tint * SheenAlbedo::table().at(cosine, roughness); }
    static float cosine(const LobePoint& at) { return cosineOfOut(at); }

    Rgb evaluate(const LobePoint& at, const Rgb& reflectance, const Vec3f& in) const {
        return evaluateLocal(*this, at, reflectance, in);
    }
    float pdfSolidAngle(const LobePoint& at, const Vec3f& in, float choice) const {
        return pdfLocal(*this, at, in, choice);
    }
    bool sample(const LobePoint& at, Vec2f u, BsdfSample& sample) const {
        return sampleLocal(*this, at, u, sample);
    }

    static Frame frame(const LobePoint& at) { return Frame(at.ns); }
    Rgb value(const Vec3f& out, const Vec3f& in) const {
        return tint * (formula(roughness, out, in) * SheenAlbedo::table().scale(roughness));
    }
    // Even over the hemisphere: what is bright is far aside.
    static float density(const Vec3f&, const Vec3f&) { return 0.5f * kInvPi; }
    static bool sampleIn(const Vec3f&, Vec2f u, Vec3f& in) {
        in = sampleUniformCone(u, 1.0f);
        return in.z > 0.0f;
    }

    // f |cos| as published.
    static float formula(float roughness, const Vec3f& out, const Vec3f& in) {
        const Vec3f h = normalize(out + in);
        const float power = 1.0f / roughness;
        const float sine = std::sqrt(std::max(0.0f, 1.0f - h.z * h.z));
        const float density =
            (2.0f + power) * pinnedPow(std::min(sine, 1.0f), power) * 0.5f * kInvPi;
        return density * in.z / (4.0f * (out.z + in.z - out.z * in.z));
    }
};

}  // namespace pm
