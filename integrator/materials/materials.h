// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "integrator/materials/lobes/glass_albedo.h"
#include "integrator/materials/material_description.h"
#include "integrator/materials/texture_source.h"

namespace pm {

// The materials of a scene, which must outlive this, and the textures that they name: null when
// none does.
struct Materials {
    std::span<const MaterialDescription> all;
    const TextureSource* textures = nullptr;
    // Of those that are rough glass, by their numbers; null of all others. Empty: there are none.
    std::span<const std::shared_ptr<const GlassAlbedo>> glass{};

    const GlassAlbedo* glassOf(std::uint32_t index) const {
        return glass.empty() ? nullptr : glass[index].get();
    }
    const MaterialDescription& operator[](std::uint32_t index) const { return all[index]; }
};

}  // namespace pm
