// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <variant>

#include "integrator/materials/lobes/dielectric.h"
#include "integrator/materials/lobes/diffuse_transmission.h"
#include "integrator/materials/lobes/ggx_reflection.h"
#include "integrator/materials/lobes/henyey_greenstein.h"
#include "integrator/materials/lobes/lambertian.h"
#include "integrator/materials/lobes/layered.h"
#include "integrator/materials/lobes/lobe_models.h"
#include "integrator/materials/lobes/mirror.h"
#include "integrator/materials/lobes/pane.h"
#include "integrator/materials/lobes/phong.h"
#include "integrator/materials/lobes/rough_diffuse.h"
#include "integrator/materials/lobes/rough_glass.h"
#include "integrator/materials/lobes/sheen.h"
#include "integrator/materials/lobes/straight.h"
#include "integrator/materials/lobes/undercoat.h"
#include "integrator/materials/material_description.h"

namespace pm {

template <DiffuseModel... Models>
using OneOfDiffuse = std::variant<Models...>;
template <ScatteringModel... Models>
using OneOfScattering = std::variant<Models...>;
template <SmoothModel... Models>
using OneOfSmooth = std::variant<Models...>;

// The lists of all lobes there are; the first of each stands where a surface has no such lobe. A
// new one is a file in lobes/, its name in one of these, and what makes it of a material's numbers:
// here of diffuse ones, of others in material_lobes.cpp.
using DiffuseLobe = OneOfDiffuse<Lambertian, Undercoat, RoughDiffuse>;
using GlossyLobe = OneOfScattering<Phong, GgxReflection, RoughGlass, DiffuseTransmission, Sheen,
                                   Layered<GgxReflection>, Layered<Sheen>,
                                   HenyeyGreenstein>;  // and broad ones
using SmoothLobe = OneOfSmooth<NotSmooth, Mirror, Dielectric, Pane>;

// lobe: as made, the first of its list. colour: of the material there, textures looked up.
inline void setDiffuseLobe(const MaterialDescription& material, const Rgb& colour,
                           DiffuseLobe& lobe) {
    if (material.diffuseRoughness > 0.0f) lobe = RoughDiffuse{material.diffuseRoughness, colour};
}

// The lobes of a surface at a point, with what each reflects or transmits.
struct Lobes {
    std::array<Rgb, kLobeCount> reflectance{};
    DiffuseLobe diffuse;
    GlossyLobe glossy;
    SmoothLobe smooth;
    Lobe glossyRole = Lobe::kGlossy;  // or kWide, kBroad

    Rgb& of(Lobe lobe) { return reflectance[static_cast<std::size_t>(lobe)]; }
    const Rgb& of(Lobe lobe) const { return reflectance[static_cast<std::size_t>(lobe)]; }
    Rgb sum() const {
        Rgb sum;
        for (const Rgb& of : reflectance) sum += of;
        return sum;
    }
    bool isSmooth() const { return !std::holds_alternative<NotSmooth>(smooth); }
};

}  // namespace pm
