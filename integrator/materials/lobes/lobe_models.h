// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <concepts>

#include "integrator/materials/lobes/lobe_point.h"
#include "integrator/materials/lobes/smooth_boundary.h"

// What a lobe has to do. Lobes are plain values, a file each; what the surface is like comes with
// the LobePoint, and what they reflect, textures and opacity included, as their reflectance.
namespace pm {

// evaluate: f |cos| for light from `in`. pdfSolidAngle: density of sample(), times `choice`, the
// probability with which the lobe is chosen. sample: finds the direction and multiplies the weight,
// which is the reflectance over that probability, by the rest of f |cos| / pdf; false where the
// direction has no value. The three agree, and in photons are the adjoint of what they are in
// radiance: tests/integrator/bsdf_test.cpp and warps_test.cpp hold both.
template <typename T>
concept ScatteringModel = requires(const T& lobe, const LobePoint& at, const Rgb& reflectance,
                                   const Vec3f& in, float choice, LobeNumbers u,
                                   BsdfSample& sample) {
    { lobe.evaluate(at, reflectance, in) } -> std::same_as<Rgb>;
    { lobe.pdfSolidAngle(at, in, choice) } -> std::same_as<float>;
    { lobe.sample(at, u, sample) } -> std::same_as<bool>;
};

// albedo: radiance along `out` of a radiance of 1 from everywhere. Maps of photons and gather
// points know irradiance only: they see nothing else of the lobe. arrival: what light from `out`
// counts for in that irradiance, more or less than 1; its mean over even light is 1.
template <typename T>
concept DiffuseModel = ScatteringModel<T> &&
    requires(const T& lobe, const LobePoint& at, const Rgb& reflectance) {
    { lobe.albedo(at, reflectance) } -> std::same_as<Rgb>;
    { lobe.arrival(at) } -> std::same_as<float>;
};

// A delta, in the roles kReflection and kRefraction. shares: what it sends on by each; asked once,
// before all else, so that it may keep what it finds. sendsByWays:
// photons leave by the ways of smooth_boundary.h, whose shares may add to more than 1. sample:
// finds the direction for the role that the sample says, and finishes the weight; pdfSolidAngle is
// the probability of the choice.
template <typename T>
concept SmoothModel = requires(T& made, const T& lobe, const LobePoint& at, float u,
                               BsdfSample& sample) {
    { made.shares(at) } -> std::same_as<SmoothShares>;
    { lobe.sendsByWays(at) } -> std::same_as<bool>;
    { lobe.sample(at, u, sample) } -> std::same_as<bool>;
};

// Where nothing is smooth.
struct NotSmooth {
    static SmoothShares shares(const LobePoint&) { return {}; }
    static bool sendsByWays(const LobePoint&) { return false; }
    static bool sample(const LobePoint&, float, BsdfSample&) { return false; }
};

}  // namespace pm
