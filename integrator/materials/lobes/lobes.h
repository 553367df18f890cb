// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <concepts>
#include <variant>

#include "integrator/materials/lobes/dielectric.h"
#include "integrator/materials/lobes/lambertian.h"
#include "integrator/materials/lobes/mirror.h"
#include "integrator/materials/lobes/pane.h"
#include "integrator/materials/lobes/phong.h"
#include "integrator/materials/lobes/straight.h"

// All lobes there are, and what a lobe has to do. A new one is a file here, its name in one of the
// lists below, and a line in material_lobes.cpp that makes it of a material's numbers. Lobes are
// plain values; what the surface is like comes with the LobePoint, and what they reflect, textures
// and opacity included, as their reflectance.
namespace pm {

// evaluate: f |cos| for light from `in`. pdfSolidAngle: density of sample(), times `choice`, the
// probability with which the lobe is chosen. sample: finds the direction and multiplies the weight,
// which is the reflectance over that probability, by the rest of f |cos| / pdf; false where the
// direction has no value. The three agree, and in photons are the adjoint of what they are in
// radiance: tests/integrator/bsdf_test.cpp and warps_test.cpp hold both.
template <typename T>
concept ScatteringModel = requires(const T& lobe, const LobePoint& at, const Rgb& reflectance,
                                   const Vec3f& in, float choice, Vec2f u, BsdfSample& sample) {
    { lobe.evaluate(at, reflectance, in) } -> std::same_as<Rgb>;
    { lobe.pdfSolidAngle(at, in, choice) } -> std::same_as<float>;
    { lobe.sample(at, u, sample) } -> std::same_as<bool>;
};

// albedo: radiance along `out` of a radiance of 1 from everywhere. Maps of photons and gather
// points know irradiance only: they see nothing else of the lobe.
template <typename T>
concept DiffuseModel = ScatteringModel<T> &&
    requires(const T& lobe, const LobePoint& at, const Rgb& reflectance) {
    { lobe.albedo(at, reflectance) } -> std::same_as<Rgb>;
};

// A delta, in the roles kReflection and kRefraction. shares: what it sends on by each. sendsByWays:
// photons leave by the ways of smooth_boundary.h, whose shares may add to more than 1. etaSquared:
// the index on the far side over this side's, squared. sample: finds the direction for the role
// that the sample says, and finishes the weight; pdfSolidAngle is the probability of the choice.
template <typename T>
concept SmoothModel = requires(const T& lobe, const LobePoint& at, float u, BsdfSample& sample) {
    { lobe.shares(at) } -> std::same_as<SmoothShares>;
    { lobe.sendsByWays(at) } -> std::same_as<bool>;
    { lobe.etaSquared() } -> std::same_as<float>;
    { lobe.sample(at, u, sample) } -> std::same_as<bool>;
};

// Where nothing is smooth.
struct NotSmooth {
    static SmoothShares shares(const LobePoint&) { return {}; }
    static bool sendsByWays(const LobePoint&) { return false; }
    static float etaSquared() { return 1.0f; }
    static bool sample(const LobePoint&, float, BsdfSample&) { return false; }
};

template <DiffuseModel... Models>
using OneOfDiffuse = std::variant<Models...>;
template <ScatteringModel... Models>
using OneOfScattering = std::variant<Models...>;
template <SmoothModel... Models>
using OneOfSmooth = std::variant<Models...>;

// The lists; the first of each stands where a surface has no such lobe.
using DiffuseLobe = OneOfDiffuse<Lambertian>;
using GlossyLobe = OneOfScattering<Phong>;  // and broad ones
using SmoothLobe = OneOfSmooth<NotSmooth, Mirror, Dielectric, Pane>;

// The lobes of a surface at a point, with what each reflects or transmits.
struct Lobes {
    std::array<Rgb, kLobeCount> reflectance{};
    DiffuseLobe diffuse;
    GlossyLobe glossy;
    SmoothLobe smooth;
    Lobe glossyRole = Lobe::kGlossy;  // or kBroad

    Rgb& of(Lobe lobe) { return reflectance[static_cast<std::size_t>(lobe)]; }
    const Rgb& of(Lobe lobe) const { return reflectance[static_cast<std::size_t>(lobe)]; }
    bool isSmooth() const { return !std::holds_alternative<NotSmooth>(smooth); }
};

}  // namespace pm
