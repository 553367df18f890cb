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
};

// Materials of the same numbers share them. Throws Error(kCancelled) soon after cancel is set.
MaterialTables makeMaterialTables(std::span<const MaterialDescription> materials,
                                  const CancelCheck& cancel);

}  // namespace pm
