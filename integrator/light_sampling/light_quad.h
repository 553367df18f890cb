// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "integrator/values/vec.h"

namespace pm {

// Where light is asked for: a point, and the shading normal on the side that is lit; unit, scene's
// own coordinates.
struct Receiver {
    Vec3f position;
    Vec3f normal;
};

// What bounds some lights, and how bright they are.
struct LightBounds {
    Vec3f centre;  // of a ball that holds the lights
    float radius = 0.0f;
    // Of a cone that holds their normals, times the cosine of its half angle; of no length where
    // that is a right angle or more.
    Vec3f axis;
    float sinSpread = 1.0f;  // of the half angle
    float strength = 0.0f;   // power, W; less where the lights are mostly hidden
};

// The bounds of up to four groups of lights side by side, in the lights' order, to be weighed and
// chosen from at once: three cache lines. Threads: const functions from any, at once.
struct alignas(64) LightQuad {
    static constexpr std::size_t kSize = 4;
    // Compilers turn what is done with it into what the processor has; the bits don't depend on it.
    using Four = float __attribute__((vector_size(16)));

    // Cosines count at least this: bounds are rounded, and shading normals lean.
    static constexpr float kLeastCosine = 0.02f;
    // No group is ever out of reach: it has at least this share.
    static constexpr float kLeastShare = 1e-4f;

    // Makes the i-th group one of lights from `first` on, which `then` divides further. Groups are
    // set from the first on, without gaps.
    void set(std::size_t i, const LightBounds& bounds, std::uint32_t first, std::uint32_t then);

    // What may arrive from each group, if nothing is in between: of the ball's points, as if they
    // were as far away as its centre. W over scene units squared, times a constant; 0 of none.
    // After Conty Estevez & Kulla, "Importance Sampling of Many Lights with Adaptive Tree
    // Splitting", 2018, section 4, with simpler bounds of the cosines.
    Four importances(const Receiver& receiver) const;
    // Chooses a group by that, and returns its number; multiplies its share into `probability`; u,
    // in [0, 1), becomes where in the share it lay, in [0, 1].
    std::size_t choose(const Receiver& receiver, double& u, float& probability) const;
    // The share with which choose() takes the i-th group.
    float share(const Receiver& receiver, std::size_t i) const;
    // Which group has the light at a place in their order.
    std::size_t groupOf(std::uint32_t position) const;

    Four x{}, y{}, z{}, radius{};
    Four axisX{}, axisY{}, axisZ{}, sinSpread{};
    Four strength{};
    Four least{};  // shares; 0 where no group is
    std::array<std::uint32_t, kSize> begin{~0u, ~0u, ~0u, ~0u};
    std::array<std::uint32_t, kSize> next{};

  private:
    Four weights(const Receiver& receiver) const;
};
static_assert(sizeof(LightQuad) == 192);

inline void LightQuad::set(std::size_t i, const LightBounds& bounds, std::uint32_t first,
                           std::uint32_t then) {
    const auto k = static_cast<int>(i);
    x[k] = bounds.centre.x;
    y[k] = bounds.centre.y;
    z[k] = bounds.centre.z;
    radius[k] = bounds.radius;
    axisX[k] = bounds.axis.x;
    axisY[k] = bounds.axis.y;
    axisZ[k] = bounds.axis.z;
    sinSpread[k] = bounds.sinSpread;
    strength[k] = bounds.strength;
    least[k] = kLeastShare;
    begin[i] = first;
    next[i] = then;
}

inline LightQuad::Four LightQuad::importances(const Receiver& receiver) const {
    const Vec3f p = receiver.position, n = receiver.normal;
    const Four dx = x - p.x, dy = y - p.y, dz = z - p.z;
    const Four d2 = dx * dx + dy * dy + dz * dz;
    Four r2 = radius * radius;
    constexpr float kSmallest = std::numeric_limits<float>::min();
    r2 = r2 > kSmallest ? r2 : Four{} + kSmallest;
    const Four far2 = d2 > r2 ? d2 : r2;
    const Four inverse =
        1.0f / Four{std::sqrt(far2[0]), std::sqrt(far2[1]), std::sqrt(far2[2]), std::sqrt(far2[3])};
    const auto cosine = [](Four c) {
        c = c > kLeastCosine ? c : Four{} + kLeastCosine;
        return c < 1.0f ? c : Four{} + 1.0f;
    };
    const Four in = cosine((n.x * dx + n.y * dy + n.z * dz + radius) * inverse);
    // cos(a - b) <= cos a cos b + sin b
    const Four out =
        cosine((radius - (axisX * dx + axisY * dy + axisZ * dz)) * inverse + sinSpread);
    // Within the ball light may arrive from anywhere.
    return strength * (inverse * inverse) * (d2 > r2 ? in * out : Four{} + 1.0f);
}

inline LightQuad::Four LightQuad::weights(const Receiver& receiver) const {
    const Four found = importances(receiver);
    const float total = (found[0] + found[1]) + (found[2] + found[3]);
    const Four lowest = least * total;
    // Where nothing is known (the comparisons are false for NaN) all the same.
    constexpr float kSmallest = 1e-30f, kLargest = std::numeric_limits<float>::max();
    if (!(total > kSmallest && total <= kLargest)) return least;
    return found > lowest ? found : lowest;
}

inline std::size_t LightQuad::choose(const Receiver& receiver, double& u,
                                     float& probability) const {
    const Four weight = weights(receiver);
    // In double, or a small share were not what its group is chosen with.
    const double first = static_cast<double>(weight[0]);
    const double second = first + static_cast<double>(weight[1]);
    const double third = second + static_cast<double>(weight[2]);
    const double total = third + static_cast<double>(weight[3]);
    // Less than the total, or there might be no group.
    const double at = std::min(u, 1.0 - 0x1p-50) * total;
    const int i = (at >= first ? 1 : 0) + (at >= second ? 1 : 0) + (at >= third ? 1 : 0);
    const std::array<double, kSize> below = {0.0, first, second, third};
    u = (at - below[static_cast<std::size_t>(i)]) / static_cast<double>(weight[i]);
    probability *= static_cast<float>(static_cast<double>(weight[i]) / total);
    return static_cast<std::size_t>(i);
}

inline float LightQuad::share(const Receiver& receiver, std::size_t i) const {
    const Four weight = weights(receiver);
    const double total = static_cast<double>(weight[0]) + static_cast<double>(weight[1]) +
                         static_cast<double>(weight[2]) + static_cast<double>(weight[3]);
    return static_cast<float>(static_cast<double>(weight[static_cast<int>(i)]) / total);
}

inline std::size_t LightQuad::groupOf(std::uint32_t position) const {
    return (position >= begin[1] ? 1 : 0) + (position >= begin[2] ? 1 : 0) +
           (position >= begin[3] ? 1 : 0);
}

}  // namespace pm
