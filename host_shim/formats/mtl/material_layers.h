// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <functional>
#include <string>

#include "host_shim/formats/mtl/mtl_dialect.h"
#include "host_shim/formats/mtl/mtl_text.h"
#include "host_shim/formats/scene_data.h"
#include "host_shim/formats/warnings.h"

namespace pm::host {

// Tells something about a statement of a material.
using MaterialNote =
    std::function<void(Warning code, const std::string& key, const std::string& text)>;

// Reads what lies on a material whose kind and maps are known, by the keys for physically based
// materials: clear coat, sheen, and which way it is brushed. All of a translated section.
void readLayers(const MtlSection& section, const Translation& translation, MaterialData& material,
                const MaterialNote& note);

// Puts -bm of a normal map or bump map into the range that the renderer takes.
void limitStrengths(MaterialData& material, const MaterialNote& note);

// Tells of all that a section asks for and that is left out.
void noteLeftOut(const MtlSection& section, const MaterialNote& note);

}  // namespace pm::host
