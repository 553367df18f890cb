// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/formats/mtl/materials.h"
#include "host_shim/formats/mtl/mtl_text.h"

namespace pm::host {

// Turns one section of an MTL file into a material that is no mixture. Errors: none; what is wrong
// is told.
MaterialData readSection(MtlSection section, const MtlSource& source, SceneFiles& files,
                         const WarningSink& warn);

// One of its maps of numbers alone, for what is made of several materials.
Boxed<TextureUse> readMapOfNumbers(const MtlSection& section, const std::string& key,
                                   const MtlSource& source, SceneFiles& files,
                                   const WarningSink& warn);

}  // namespace pm::host
