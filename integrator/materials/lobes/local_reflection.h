// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <concepts>

#include "integrator/materials/lobes/lobe_point.h"
#include "integrator/sampling/warps.h"

namespace pm {

// A lobe that reflects, in a frame of its own whose z is the shading normal. albedo: of even light
// along a cosine. value: f |cos|, and density: of sampleIn(), sr^-1; both directions above the
// surface. sampleIn: false where the direction has no value.
template <typename T>
concept LocalReflection = requires(const T& lobe, const LobePoint& at, const Vec3f& out,
                                   const Vec3f& in, float cosine, Vec2f u, Vec3f& sampled) {
    { lobe.frame(at) } -> std::same_as<Frame>;
    { lobe.albedo(cosine) } -> std::same_as<Rgb>;
    { lobe.value(out, in) } -> std::same_as<Rgb>;
    { lobe.density(out, in) } -> std::same_as<float>;
    { lobe.sampleIn(out, u, sampled) } -> std::same_as<bool>;
};

// The cosine that counts: none is so small that nothing is reflected.
inline float cosineOfOut(const LobePoint& at) {
    return std::max(1e-4f, dot(at.out, at.ns));
}

// What a ScatteringModel does, of such a lobe. A value of which the reflectance is not all yet,
// for textures and opacity, is in proportion.
template <LocalReflection Model>
Rgb evaluateLocal(const Model& lobe, const LobePoint& at, const Rgb& reflectance, const Vec3f& in) {
    if (!at.isReflection(in)) return {};
    const Frame frame = lobe.frame(at);
    const Vec3f out = frame.toLocal(at.out), local = frame.toLocal(in);
    if (!(out.z > 0.0f && local.z > 0.0f)) return {};
    return inProportion(reflectance, lobe.albedo(cosineOfOut(at)), lobe.value(out, local)) *
           at.adjointCorrection(in);
}

template <LocalReflection Model>
float pdfLocal(const Model& lobe, const LobePoint& at, const Vec3f& in, float choice) {
    const Frame frame = lobe.frame(at);
    const Vec3f out = frame.toLocal(at.out), local = frame.toLocal(in);
    if (!(out.z > 0.0f && local.z > 0.0f)) return 0.0f;
    return choice * lobe.density(out, local);
}

template <LocalReflection Model>
bool sampleLocal(const Model& lobe, const LobePoint& at, Vec2f u, BsdfSample& sample) {
    const Frame frame = lobe.frame(at);
    const Vec3f out = frame.toLocal(at.out);
    Vec3f in;
    if (!(out.z > 0.0f) || !lobe.sampleIn(out, u, in)) return false;
    sample.direction = normalize(frame.toWorld(in));
    sample.weight = inProportion(sample.weight, lobe.albedo(cosineOfOut(at)), lobe.value(out, in)) *
                    (at.adjointCorrection(sample.direction) / lobe.density(out, in));
    return at.isReflection(sample.direction);
}

}  // namespace pm
