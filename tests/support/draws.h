// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/sampling/sampler.h"

namespace pm::test {

// A sampler's numbers one after another, each of an event of its own: for tests that follow no
// path.
class Draws {
  public:
    Draws(std::uint64_t seed, std::uint64_t stream, std::uint64_t sequence, std::uint32_t index)
        : m_sampler(seed, stream, sequence, index) {}

    float next1D() {
        m_sampler.nextEvent();
        return m_sampler.get1D(Purpose::kPlace);
    }
    Vec2f next2D() {
        m_sampler.nextEvent();
        return m_sampler.get2D(Purpose::kPlace);
    }

  private:
    Sampler m_sampler;
};

}  // namespace pm::test
