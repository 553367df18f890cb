// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>

namespace pm {

// Three channels in the scene-linear rendering space: radiance, flux, reflectance or a weight; the
// variable's name says which.
struct Rgb {
    float r{}, g{}, b{};

    constexpr Rgb() = default;
    constexpr Rgb(float r_, float g_, float b_) : r(r_), g(g_), b(b_) {}
    constexpr explicit Rgb(float s) : r(s), g(s), b(s) {}

    constexpr Rgb& operator+=(const Rgb& c) { return *this = *this + c; }
    constexpr Rgb& operator*=(const Rgb& c) { return *this = *this * c; }
    constexpr Rgb& operator*=(float s) { return *this = *this * s; }
    constexpr float operator[](int channel) const {
        return channel == 0 ? r : channel == 1 ? g : b;
    }

    friend constexpr Rgb operator+(const Rgb& a, const Rgb& c) {
        return {a.r + c.r, a.g + c.g, a.b + c.b};
    }
    friend constexpr Rgb operator-(const Rgb& a, const Rgb& c) {
        return {a.r - c.r, a.g - c.g, a.b - c.b};
    }
    friend constexpr Rgb operator*(const Rgb& a, const Rgb& c) {
        return {a.r * c.r, a.g * c.g, a.b * c.b};
    }
    friend constexpr Rgb operator*(const Rgb& a, float s) { return {a.r * s, a.g * s, a.b * s}; }
    friend constexpr Rgb operator*(float s, const Rgb& a) { return a * s; }
    friend constexpr Rgb operator/(const Rgb& a, float s) { return {a.r / s, a.g / s, a.b / s}; }
    friend constexpr bool operator==(const Rgb& a, const Rgb& b) = default;
};

constexpr bool isBlack(const Rgb& c) {
    return c.r == 0.0f && c.g == 0.0f && c.b == 0.0f;
}
// Over the channels; in double, as many are summed.
constexpr double channelSum(const Rgb& c) {
    return static_cast<double>(c.r) + static_cast<double>(c.g) + static_cast<double>(c.b);
}
constexpr double channelMean(const Rgb& c) {
    return channelSum(c) / 3;
}
constexpr float maxChannel(const Rgb& c) {
    return std::max(c.r, std::max(c.g, c.b));
}
inline bool isFinite(const Rgb& c) {
    return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b);
}

}  // namespace pm
