// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "integrator/transport/frame/bad_samples.h"
#include "integrator/transport/frame/channel_layout.h"
#include "integrator/transport/path/direct_light.h"

namespace pm {

// Sums over a pixel's samples of one pass, in double and in the order of the samples, and the
// pixel's floats that come of them.
class PixelSums {
  public:
    // Why the sample may not be added: a part of its radiance or all together is NaN, infinite or
    // negative. A colour outside of the space's gamut has channels below 0, so R + G + B is looked
    // at.
    static std::optional<FaultySample> faultOf(const SampleRadiance& sample);

    // depth: of where the sample's path first met something, along the view axis, scene units.
    // isSeen: adaptive renders decide by it, see ChannelLayout::seen.
    void add(const SampleRadiance& sample, double depth, bool isSeen);
    // samples: the pixel's, those that were not accepted included, > 0. pixel: layout.count floats.
    void write(const ChannelLayout& layout, std::uint32_t samples, float* pixel) const;

  private:
    std::array<double, 3> m_emission{}, m_direct{}, m_caustic{}, m_indirect{}, m_biasProbe{},
        m_albedo{}, m_normal{};
    double m_coverage = 0, m_depth = 0;
    // Where a sample first met something.
    struct FirstHit {
        bool any = false;
        std::uint32_t shape = 0, material = 0;
        Vec3f position, normal;

        // Other objects or materials, a bend, or one behind the other.
        bool isUnlike(const FirstHit& other) const;
    };
    void addSeen(const SampleRadiance& sample);

    std::array<double, 6> m_seen{};  // as ChannelLayout::seen
    FirstHit m_firstSeen;
    float m_contribution = 0.0f;  // of the last sample
};

}  // namespace pm
