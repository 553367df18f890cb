// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <bit>
#include <cstdint>

#include "integrator/values/vec.h"

namespace pm {

// 2^level, level in [-126, 127].
inline float powerOfTwo(int level) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(level + 127) << 23);
}

// The ball where gather rays read most of the photons, in a scene that reaches far beyond it.
// Photons are aimed at it and at balls around it, each twice as wide as the one before, so that
// their density falls with the square of the distance from the centre; estimates widen with the
// distance, by powers of two, and hold as many everywhere.
struct Focus {
    Vec3f centre;
    float inverseRadiusSquared = 0.0f;  // scene units^-2; 0: everywhere is in focus

    bool isEverywhere() const { return !(inverseRadiusSquared > 0.0f); }
    // How many balls beyond the first the position lies in: the radius of estimates there is
    // powerOfTwo(level) times that in focus. In [0, 63].
    int levelAt(const Vec3f& position) const {
        const float d2 = lengthSquared(position - centre) * inverseRadiusSquared;
        if (!(d2 > 1.0f)) return 0;
        const int exponent = static_cast<int>(std::bit_cast<std::uint32_t>(d2) >> 23) - 127;
        return exponent / 2 + 1;
    }

    friend bool operator==(const Focus&, const Focus&) = default;
};

}  // namespace pm
