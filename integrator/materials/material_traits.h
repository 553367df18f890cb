// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>
#include <string>
#include <vector>

#include "integrator/materials/lobe_roles.h"
#include "integrator/materials/material_description.h"

namespace pm {

// What light may find at a material, anywhere on it, whatever its textures: of a mixture at any of
// its parts. All that doesn't make lobes itself asks for this.
struct MaterialTraits {
    bool isBlack = true;          // light goes nowhere from there
    bool isInvisible = true;      // light passes as if nothing were there: met by no ray
    bool isOpaque = true;         // nothing goes on behind it
    bool isOfSurface = true;      // no mirror's or glass's: what is seen in it is not its texture
    bool isDiffuse = false;       // it has a diffuse lobe: photons may be kept at it
    bool isGlossy = false;        // it may have a lobe that is glossy, wide or broad
    bool isWide = false;          // a wide or broad one
    bool castsCaustics = false;   // by another lobe than diffuse or broad ones, or straight on
    bool hasDelta = false;        // light may leave in one direction, or two
    bool transmits = false;       // light may go on behind it, through glass or straight
    bool isGlass = false;         // a boundary of a medium, or a pane
    bool fillsItsInside = false;  // a medium does
    bool isThinWalled = false;
    bool absorbs = false;      // that takes light
    bool isUnbending = false;  // glass of index 1, with no priority over other glass
    bool isCutAway = false;    // a share of it may not be there
    bool isStretched = false;  // its facets are longer along the tangent
    bool emits = false;
    bool shinesUnevenly = false;  // another radiance here than there
    bool filtersTextures = false;
    bool looksUpTextures = false;
    bool hasBroadNumbers = false;  // for times that the plan expects

    // Whether light may go straight on, whatever is on its sides.
    bool letsThrough() const { return isCutAway || isUnbending; }
    // Whether it lets some light straight on and scatters some, as half-transparent sheets do.
    bool isSheet() const { return isCutAway && isDiffuse && !isGlass; }
};

// Of all materials, in their order. Mixtures have what mixtures have to have: see
// completeMixtures().
std::vector<MaterialTraits> traitsOf(std::span<const MaterialDescription> materials,
                                     const LobeRoles& roles);

// A mixture has at most so many parts that are none.
inline constexpr std::size_t kMostParts = 6;

// Gives each mixture the medium of its part that is glass, and tangents where a part asks for them.
// Throws Error(kInvalidScene) where one names itself, directly or not, a material that there is
// not, two unlike kinds of glass, or has too many parts.
void completeMixtures(std::vector<MaterialDescription>& materials);

}  // namespace pm
