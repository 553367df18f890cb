// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <vector>

#include "integrator/lights/environment.h"
#include "integrator/values/vec.h"

namespace pm {

// The sky in parts of equal solid angle, each worth more or less to aim from: that behind a floor
// or a wall reaches nothing.
// Threads: const functions from any, at once.
class SkyParts {
  public:
    static constexpr std::uint32_t kBands = 8;  // by height; as many parts around
    static constexpr std::uint32_t kCount = kBands * kBands;

    // In which part a unit direction is, as it is looked along.
    static std::uint32_t partOf(const Vec3f& seen);

    // Nothing is known yet: all parts are alike.
    bool empty() const { return m_worth.empty(); }
    // worth: of each part, > 0.
    void setWorth(std::vector<float> worth) { m_worth = std::move(worth); }
    float worth(std::uint32_t part) const { return m_worth[part]; }

    // Takes one of several directions of the environment by its part's worth, in place of the one
    // that `uDirection` stands for: uDirection becomes that one's, uChoice what is left of it, in
    // [0, 1). Returns what its flux is to be multiplied by. Resampled importance sampling (Talbot
    // et al. 2005); the directions may depend on each other, as long as each comes as it would
    // alone.
    float choose(const Environment& environment, float& uChoice, Vec2f& uDirection) const;

  private:
    std::vector<float> m_worth;
};

}  // namespace pm
