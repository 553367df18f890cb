// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/materials/lobe_kinds.h"
#include "integrator/materials/materials.h"
#include "integrator/shapes/surface.h"

namespace pm {

// The lobes that a surface has by its material's numbers, textures looked up there: all but the
// straight one. They may reflect more than comes in. lobes: as made, empty.
void setLobes(const Materials& materials, const Surface& surface, const LobePoint& at,
              Lobes& lobes);

}  // namespace pm
