// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/materials/lobe_kinds.h"
#include "integrator/materials/materials.h"
#include "integrator/shapes/surface.h"

namespace pm {

// The lobes that a surface has by a material's numbers, textures looked up there: all but the
// straight one. They may reflect more than comes in. index: of the material, which is no mixture.
// lobes: as made, empty.
void setLobes(const Materials& materials, std::uint32_t index, const Surface& surface,
              const LobePoint& at, Lobes& lobes);

}  // namespace pm
