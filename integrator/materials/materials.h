// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <span>

#include "integrator/materials/lobe_roles.h"
#include "integrator/materials/material_description.h"
#include "integrator/materials/material_tables.h"
#include "integrator/materials/texture_source.h"

namespace pm {

// The materials of a scene, which must outlive this, and the textures that they name: null when
// none does.
struct Materials {
    std::span<const MaterialDescription> all;
    const TextureSource* textures = nullptr;
    const MaterialTables* tables = nullptr;  // null: no material needs one
    LobeRoles roles{};

    TablesOf tablesOf(std::uint32_t index) const {
        return tables && !tables->all.empty() ? tables->all[index] : TablesOf{};
    }
    const MaterialDescription& operator[](std::uint32_t index) const { return all[index]; }
};

}  // namespace pm
