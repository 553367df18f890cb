// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <functional>

#include "integrator/materials/lobes/ggx_albedo.h"
#include "integrator/materials/lobes/table_cell.h"

namespace pm {

// By how much less than uncovered a rough lobe reflects from one direction to another below a layer
// that lets w(mu) of even light pass: d(in) d(out). d is such that a white lobe below sends back
// along mu what the layer leaves, w(mu): energy is kept and the whole is reciprocal, whatever the
// lobe's width. Of a mirror that is the root of w, of a diffuse lobe w over the root of its mean;
// between them it is found by scaling the rows and columns of the lobe's own matrix (Sinkhorn &
// Knopp, "Concerning nonnegative matrices and doubly stochastic matrices", 1967).
// Threads: const functions from any.
class LayerPass {
  public:
    // passes: w of a cosine in (0, 1], in (0, 1].
    explicit LayerPass(const std::function<float(float)>& passes);

    // d, of a lobe's alpha, in (0, 1].
    float at(float cosine, float alpha) const;
    // What the lobe below then sends back of even light along a cosine: `once` as GgxShares have
    // it, and `more` of what is scattered more than once.
    struct Below {
        GgxShares once;
        float more = 0.0f;
    };
    Below below(float cosine, float alpha) const;

  private:
    struct Entry {
        float d;
        Below below;
    };
    using Row = std::array<Entry, kLobeTableSize>;  // by the root of the cosine
    static Row scaled(const std::array<float, kLobeTableSize>& passes, float alpha);

    std::array<Row, kLobeTableSize> m_rows;  // by roughness
};

}  // namespace pm
