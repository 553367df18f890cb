// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "integrator/sampling/sampler.h"

namespace pm {

// Where surfaces reflect nearly all light a photon lands thousands of times, and each landing is as
// good as one of another photon. There few photons make long chains of landings, by Russian
// roulette with bounded weights; all of them land once, as where surfaces are darker that is half
// of the light.
// - After the first landing one chain in `oneIn` goes on, after 4, 16, 64, ... landings half of
//   them, and counts for all: its weight grows as the root of the number of landings. Which ones is
//   systematic: of a power of two of photons always the same number goes on. Where few are left
//   all do, and their landings are stored the more seldom.
// - What surfaces absorb is taken off a chain's flux until little is left. A landing is stored with
//   the probability of what is left, for as much flux as any other.
class LongChains {
  public:
    // One photon's.
    struct Chain {
        std::uint32_t index = 0;     // of the photon
        std::uint32_t landings = 0;  // 0: it has not begun
        int halvings = 0;            // of the chains, that it has outlived
        float reference = 0.0f;      // flux that a stored landing stands for, W, over all channels
    };

    // oneIn: a power of two; 0: every landing is stored. share: of the photons, those that begin
    // chains. key: of the pass.
    LongChains(std::uint32_t oneIn, std::uint64_t count, float share, std::uint64_t key)
        : m_oneIn(oneIn),
          m_share(static_cast<double>(share)),
          m_scramble(static_cast<std::uint32_t>(mixBits(key))),
          m_mostHalvings(mostHalvings(static_cast<double>(count) * m_share)) {}

    bool areOn() const { return m_oneIn > 0; }
    // Photons that begin chains.
    bool begins(std::uint32_t index) const { return rank(index) < m_share; }

    // A photon of that flux has landed.
    static void land(Chain& chain, float flux) {
        if (chain.landings++ == 0) chain.reference = flux;
    }
    // With which the landing is stored.
    float storing(const Chain& chain, float flux) const {
        const int more = due(chain) - chain.halvings;
        return std::min(1.0f, flux / chain.reference) * powerOfTwo(-more);
    }
    // What the flux that leaves the landing is multiplied by; 0: the chain ends.
    float goOn(Chain& chain) const {
        const int halvings = std::min(due(chain), m_mostHalvings);
        const float factor = powerOfTwo(halvings - chain.halvings);
        if (factor == 1.0f) return factor;
        chain.halvings = halvings;
        chain.reference *= factor;
        return rank(chain.index) < m_share * static_cast<double>(powerOfTwo(-halvings)) ? factor
                                                                                        : 0.0f;
    }
    // Nothing is absorbed by chance from what leaves so much.
    static bool keeps(const Chain& chain, float flux) {
        return chain.landings > 0 && flux >= kLeast * chain.reference;
    }

    // So many photons, or a few more, as chains are shared out best.
    static std::uint64_t wholeNumber(std::uint64_t count) {
        const std::uint64_t unit = std::uint64_t{1} << mostHalvings(static_cast<double>(count));
        return (count + unit - 1) / unit * unit;
    }

  private:
    static constexpr double kFewestChains = 16;
    static constexpr float kLeast = 1.0f / 32;

    static int mostHalvings(double chains) {
        return log2(static_cast<std::uint64_t>(std::max(1.0, chains / kFewestChains)));
    }
    // Of 1 or more, rounded down.
    static int log2(std::uint64_t number) { return static_cast<int>(std::bit_width(number)) - 1; }
    static float powerOfTwo(int exponent) { return std::ldexp(1.0f, exponent); }
    double rank(std::uint32_t index) const {
        return static_cast<double>(reverseBits(index) ^ m_scramble) * 0x1p-32;
    }
    // After so many landings.
    int due(const Chain& chain) const {
        return chain.landings == 0 ? 0 : log2(m_oneIn) + log2(chain.landings) / 2;
    }

    std::uint32_t m_oneIn;
    double m_share;
    std::uint32_t m_scramble;
    int m_mostHalvings;
};

}  // namespace pm
