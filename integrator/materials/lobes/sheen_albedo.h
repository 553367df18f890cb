// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>

#include "integrator/materials/lobes/table_cell.h"

namespace pm {

// What Sheen reflects of even light, and by how much it is less than its formula so that this is
// nowhere more than all. Made when first asked for. Threads: any.
class SheenAlbedo {
  public:
    static const SheenAlbedo& table();

    // cosine in (0, 1], roughness in [kLeastSheenRoughness, 1].
    float at(float cosine, float roughness) const;
    float scale(float roughness) const;

  private:
    SheenAlbedo();

    std::array<std::array<float, kLobeTableSize>, kLobeTableSize> m_reflected;  // [roughness][root]
    std::array<float, kLobeTableSize> m_scale;
};

}  // namespace pm
