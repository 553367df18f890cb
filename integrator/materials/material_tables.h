// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "integrator/materials/lobes/glass_albedo.h"
#include "integrator/materials/lobes/layer_pass.h"
#include "integrator/materials/lobes/stretched_albedo.h"
#include "integrator/materials/material_description.h"
#include "integrator/values/cancel_check.h"

namespace pm {

// What a material's lobes look up that depends on its numbers; null where they need none.
struct TablesOf {
    const GlassAlbedo* glass = nullptr;          // of rough glass
    const LayerPass* pass = nullptr;             // of a rough lobe under a layer
    const StretchedAlbedo* stretched = nullptr;  // of stretched facets
};

// By material; empty where none needs one. Owned by what else is here.
struct MaterialTables {
    std::vector<TablesOf> all;
    std::vector<std::shared_ptr<const void>> made;
    std::vector<std::shared_ptr<const GlassAlbedo>> glass;  // all, by growing index

    // Of the index that is nearest; null where there is no rough glass.
    const GlassAlbedo* glassOf(float ior) const;
};

// Materials of the same numbers share them. mayTouch: rough glass may have other glass on its other
// side. Throws Error(kCancelled) soon after cancel is set.
MaterialTables makeMaterialTables(std::span<const MaterialDescription> materials, bool mayTouch,
                                  const CancelCheck& cancel);

}  // namespace pm
