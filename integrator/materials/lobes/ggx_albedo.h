// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>

#include "integrator/materials/lobes/table_cell.h"

namespace pm {

// Of a rough surface: what it reflects of even light in one scattering, without what its facets
// absorb, and split for Schlick's curve: F0 * normal + (1 - F0) * grazing.
struct GgxShares {
    float normal = 1.0f, grazing = 0.0f;

    // What even light loses by being scattered more than once.
    float missing() const { return 1.0f - normal; }
};

// The table of it, made when first asked for: 32 x 32, each entry of 1024 visible normals.
// Threads: any.
class GgxAlbedo {
  public:
    static const GgxAlbedo& table();

    // cosine in (0, 1], alpha in (0, 1].
    GgxShares at(float cosine, float alpha) const;
    // The mean over directions, each by its cosine.
    GgxShares mean(float alpha) const;

  private:
    static constexpr std::size_t kSize = kLobeTableSize;

    GgxAlbedo();

    std::array<std::array<GgxShares, kSize>, kSize> m_shares;  // [roughness][root of the cosine]
    std::array<GgxShares, kSize> m_means;
};

}  // namespace pm
