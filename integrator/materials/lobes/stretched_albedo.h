// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>

#include "integrator/values/vec.h"

namespace pm {

// What white facets that are stretched lose of even light in one scattering: as GgxAlbedo, for one
// stretch, and by where the light goes round the normal. Threads: const functions from any.
class StretchedAlbedo {
  public:
    // stretch: as Ggx has it.
    explicit StretchedAlbedo(float stretch);

    // w: unit, above the surface, in the facets' frame. alpha: in (0, 1].
    float missing(const Vec3f& w, float alpha) const;
    // The mean over directions, each by its cosine.
    float meanMissing(float alpha) const;

  private:
    static constexpr std::size_t kSize = 16, kTurns = 5;  // of a quarter turn
    using Row = std::array<std::array<float, kTurns>, kSize>;

    static float inRow(const Row& row, const Vec3f& w);

    std::array<Row, kSize> m_rows;  // [roughness][root of the cosine][sine squared of the turn]
    std::array<float, kSize> m_means;
};

}  // namespace pm
