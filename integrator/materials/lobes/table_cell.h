// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pm {

// Where in a table of values at 0, 1 / (size - 1), ... 1 a place lies: between low and low + 1.
struct TableCell {
    std::size_t low;
    float part;

    // at: clamped to [0, 1]; size: 2 or more.
    TableCell(float at, std::size_t size) {
        const float x = std::clamp(at, 0.0f, 1.0f) * static_cast<float>(size - 1);
        low = std::min(static_cast<std::size_t>(x), size - 2);
        part = x - static_cast<float>(low);
    }
};

// Tables of what lobes reflect of even light: even in the root of the cosine, and in roughness.
inline constexpr std::size_t kLobeTableSize = 32;

inline float tableCosine(std::size_t c) {
    constexpr float kLeast = 1e-4f;
    const float root = static_cast<float>(c) / (kLobeTableSize - 1);
    return std::max(kLeast, root * root);
}
inline float tableAlpha(std::size_t r) {
    constexpr float kLeast = 1e-5f;
    const float roughness = static_cast<float>(r) / (kLobeTableSize - 1);
    return std::max(kLeast, roughness * roughness);
}
inline TableCell cellOfCosine(float cosine) {
    return {std::sqrt(cosine), kLobeTableSize};
}
inline TableCell cellOfAlpha(float alpha) {
    return {std::sqrt(alpha), kLobeTableSize};
}

// The mean over directions, each by its cosine, of what is a function of that.
template <typename F>
auto meanOverCosines(const F& ofCosine, int steps = 1024) {
    auto sum = ofCosine(std::sqrt(0.5f / static_cast<float>(steps)));
    for (int i = 1; i < steps; ++i)  // of 2 mu d mu = d mu^2, which is even
        sum += ofCosine(std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(steps)));
    return sum / static_cast<decltype(sum)>(steps);
}

}  // namespace pm
