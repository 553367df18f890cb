// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/materials/lobes/lobe.h"
#include "integrator/materials/material_description.h"

namespace pm {

// From where on a glossy lobe is broad, and wide: by the roughness of facets, and up to the
// exponent of a Phong lobe. The lobes know nothing of it: it is what an integrator does with them.
struct LobeRoles {
    // Half of a Phong lobe's greatest value lies 10 degrees aside, or farther; facets have half of
    // D's 5 degrees aside. What is so broad casts no caustics.
    float broadRoughness = 0.369f, broadExponent = 45.0f;
    // Of metal, which sends on all that it gets: a gather ray that meets its highlight brings far
    // more than others, and photons that it has spread lie evenly.
    float broadRoughnessOfMetal = 0.65f;
    // From here on a ray along a lobe seldom finds a lamp's image: photons do it better.
    float wideRoughness = 0.25f, wideExponent = 510.0f;
};

// The role of what is glossy of a material that is no mixture, by its numbers alone, whatever their
// textures.
inline Lobe glossyRoleOf(const MaterialDescription& material, const LobeRoles& roles) {
    // Glass is never broad: what goes through it is none of the surface's.
    const float broad =
        material.kind == MaterialKind::kMirror ? roles.broadRoughnessOfMetal : roles.broadRoughness;
    if (material.kind != MaterialKind::kDielectric &&
        isAtLeastAsRough(material, broad, roles.broadExponent))
        return Lobe::kBroad;
    return isAtLeastAsRough(material, roles.wideRoughness, roles.wideExponent) ? Lobe::kWide
                                                                               : Lobe::kGlossy;
}

}  // namespace pm
