// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/geometry/face_pattern.h"

namespace pm {

// The pattern of a large quad: a grid whose outermost ring of cells is in place of four strips,
// each sewn to the points of its edge. Parts: blocks of the inner cells, then the strips.
class QuadBlocks {
  public:
    static constexpr int kSide = 32;  // cells along a block

    explicit QuadBlocks(EdgeRates rates);
    // Whether a quad with such rates is sampled so.
    static bool fit(EdgeRates rates);

    std::uint32_t parts() const { return blocks() + 4; }
    std::uint32_t triangles(std::uint32_t part) const;
    void make(std::uint32_t part, FacePattern& pattern) const;
    PatternDomain domain(std::uint32_t part) const;

  private:
    // Grid points, both ends included.
    struct Block {
        int i0, i1, j0, j1;
    };
    std::uint32_t blocks() const;
    Block block(std::uint32_t part) const;
    PatternPoint gridPoint(int i, int j) const;
    void makeStrip(std::uint32_t side, FacePattern& pattern) const;
    PatternPoint innerPoint(std::uint32_t side, int b) const;
    PatternPoint outerPoint(std::uint32_t side, int a) const;
    int along(std::uint32_t side) const { return side % 2 == 0 ? m_cells[0] : m_cells[1]; }

    EdgeRates m_rates;
    int m_cells[2];  // along u and v, at least 2
};

}  // namespace pm
