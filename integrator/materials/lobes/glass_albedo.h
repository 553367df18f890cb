// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>

#include "integrator/materials/lobes/ggx.h"
#include "integrator/materials/lobes/table_cell.h"

namespace pm {

// What a rough boundary of glass reflects and lets through of even light in one scattering, from
// either side, and how what is missing is shared between both: see RoughGlass.
// Threads: const functions from any.
class GlassAlbedo {
  public:
    // One side: 0 is outside, where the index is 1, 1 is inside, where it is ior. ior > 0.
    explicit GlassAlbedo(float ior);

    // Of glass of index 1.5.
    static const GlassAlbedo& usual();

    float ior() const { return m_ior; }
    // 1 less what goes on, in [0, 1). cosine in (0, 1], alpha in (0, 1].
    float missing(int side, float cosine, float alpha) const;
    float meanMissing(int side, float alpha) const;
    // Of what is missing on a side, the share that leaves on the other.
    float crossing(int side, float alpha) const;

  private:
    static constexpr std::size_t kSize = kLobeTableSize;
    struct Row {  // of a roughness
        std::array<float, kSize> missing;
        float mean = 0;
    };
    void fill(int side, std::size_t r);

    float m_ior;
    std::array<std::array<Row, kSize>, 2> m_rows;
    std::array<float, 2> m_letsThrough;  // of a smooth boundary, in the mean
};

}  // namespace pm
