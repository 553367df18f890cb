// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "integrator/values/vec.h"

// Owen-scrambled Sobol points by hashing, "padded": every pair of dimensions is the (0,2)-sequence
// of Sobol's first two dimensions with a scramble and a shuffle of its own. [1] Laine & Karras,
// "Stratified Sampling for Stochastic Transparency", 2011. [2] Burley, "Practical Hash-based Owen
// Scrambling", JCGT 9(4), 2020.
namespace pm {

// Bijection of 64 bits without visible structure (the finaliser of SplitMix64).
constexpr std::uint64_t mixBits(std::uint64_t x) {
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9ull;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebull;
    x ^= x >> 31;
    return x;
}

constexpr std::uint64_t combineBits(std::uint64_t a, std::uint64_t b) {
    return mixBits(a + 0x9e3779b97f4a7c15ull + mixBits(b + 0x632be59bd9b4e019ull));
}

constexpr std::uint32_t reverseBits(std::uint32_t x) {
    x = __builtin_bswap32(x);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
    x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
    return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

// Owen scrambling of a number whose bits are reversed: each bit is flipped by a hash of the bits
// below it only [1, 2].
constexpr std::uint32_t owenScrambleReversed(std::uint32_t x, std::uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

// Sobol's second dimension of index i, bits reversed: Pascal's matrix modulo 2, applied in five
// steps because it is a Kronecker power of [[1,1],[0,1]] (Lucas' theorem).
constexpr std::uint32_t sobolSecondReversed(std::uint32_t i) {
    i ^= (i >> 1) & 0x55555555u;
    i ^= (i >> 2) & 0x33333333u;
    i ^= (i >> 4) & 0x0f0f0f0fu;
    i ^= (i >> 8) & 0x00ff00ffu;
    i ^= (i >> 16) & 0x0000ffffu;
    return i;
}

// In [0, 1): the upper 24 bits.
constexpr float toUnitFloat(std::uint32_t x) {
    return static_cast<float>(x >> 8) * 0x1p-24f;
}

// The first of two such numbers, in finer steps than its own 2^-24, which ten thousand choices
// would use up: the steps' fractions are made of both numbers' bits.
inline double refined(Vec2f u) {
    const std::uint64_t bits = mixBits(std::uint64_t{std::bit_cast<std::uint32_t>(u.x)} << 32 |
                                       std::bit_cast<std::uint32_t>(u.y));
    return static_cast<double>(u.x) + static_cast<double>(bits >> 40) * 0x1p-48;
}

inline float toBelowOne(double x) {
    return std::min(static_cast<float>(x), 1.0f - 0x1p-24f);
}

// What a random number decides. Each event of a path has one number, or pair, for each of these,
// whether or not the others are asked for: so nothing that a scene does without changes what it
// has.
enum class Purpose : std::uint8_t {
    kPlace,      // where a path begins: on the frame, on a light
    kLens,       // on the camera's aperture
    kTime,       // while the shutter is open
    kLight,      // which light a photon leaves
    kDistance,   // how far to the next event in a medium
    kLobe,       // by which lobe, or lobes, a path goes on
    kDirection,  // where to
    kRoulette,
    kDirect,        // next-event estimation, from the side that is looked at
    kDirectBehind,  // and from the other one
    kCaustic,       // next-event estimation of caustics
    kRefocused,     // whether refocused light is estimated
    kHidden,        // whether a photon meets what is hidden from some rays
    kAim,           // whether scattered photons are aimed
    kAimedDirection,
    kDescent,  // whether what descends from a caustic is followed
    kStore,    // whether a photon is kept where it lands
    kPilot,    // a pilot's own choice, where its path has stopped
    kWay,      // reflected, or let through, where a lobe does both
    kCopies,   // how many photons of the mean flux go on in place of one
};

// The random numbers of one path, or of one of its branches: a function of (seed, stream, sequence,
// index, branch, event, purpose) alone, whatever else was asked for before. `sequence` names a set
// of points that is stratified together (a pixel of one pass, or all photons of a pass); `index` is
// the point's number in it.
class Sampler {
  public:
    Sampler(std::uint64_t seed, std::uint64_t stream, std::uint64_t sequence, std::uint32_t index)
        : m_key(combineBits(combineBits(seed, stream), sequence)),
          m_reversedIndex(reverseBits(index)) {}

    // Range: [0, 1).
    float get1D(Purpose purpose) const {
        const std::uint64_t hash = hashOf(purpose);
        const std::uint32_t shuffled = shuffle(hash);
        return toUnitFloat(
            reverseBits(owenScrambleReversed(shuffled, static_cast<std::uint32_t>(mixBits(hash)))));
    }

    // Range: [0, 1)^2.
    Vec2f get2D(Purpose purpose) const {
        const std::uint64_t hash = hashOf(purpose);
        const std::uint32_t shuffled = shuffle(hash);
        const std::uint64_t seeds = mixBits(hash);
        return {toUnitFloat(
                    reverseBits(owenScrambleReversed(shuffled, static_cast<std::uint32_t>(seeds)))),
                toUnitFloat(reverseBits(owenScrambleReversed(
                    sobolSecondReversed(shuffled), static_cast<std::uint32_t>(seeds >> 32))))};
    }

    // To the path's next event.
    void nextEvent() { m_event += kPurposes; }
    // Those of a path that leaves this one here, from its first event on. Each `which` has its own,
    // and none are those of the path itself.
    Sampler branch(std::uint32_t which) const {
        Sampler other(*this);
        other.m_key = combineBits(m_key, std::uint64_t{which} << 32 | m_event);
        other.m_event = 0;
        return other;
    }
    // The same event of another point of the sequence.
    Sampler at(std::uint32_t index) const {
        Sampler other(*this);
        other.m_reversedIndex = reverseBits(index);
        return other;
    }
    // Where a sample takes `count` points for a purpose, a power of two, in place of one: what has
    // the i-th of them. Those of all indices are one sequence, those of one index an even part of
    // it; count x index is below 2^32.
    Sampler part(std::uint32_t count, std::uint32_t i) const {
        Sampler other(*this);
        other.m_reversedIndex = m_reversedIndex >> std::countr_zero(count) | reverseBits(i);
        return other;
    }

  private:
    static constexpr std::uint32_t kPurposes = 32;  // of an event; a constant, so that more change
                                                    // no number

    std::uint64_t hashOf(Purpose purpose) const {
        return mixBits(m_key +
                       0x9e3779b97f4a7c15ull * (m_event + static_cast<std::uint32_t>(purpose) + 1));
    }
    std::uint32_t shuffle(std::uint64_t hash) const {
        return reverseBits(
            owenScrambleReversed(m_reversedIndex, static_cast<std::uint32_t>(hash >> 32)));
    }

    std::uint64_t m_key;
    std::uint32_t m_reversedIndex;
    std::uint32_t m_event = 0;
};

}  // namespace pm
