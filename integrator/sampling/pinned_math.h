// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <numbers>

// Transcendental functions that reach a pixel. The C library picks variants by processor, so its
// last bits change from machine to machine; these are plain arithmetic and don't. Errors stated are
// for the double result; tests hold them.
namespace pm {

struct SinCos {
    float sin, cos;
};

// sine and cosine of 2 pi turns, for turns in [0, 1]. Absolute error below 1e-13 before rounding to
// float (Taylor series on [-pi/4, pi/4]).
inline SinCos sinCosTurns(float turns) {
    const double quarters = 4.0 * static_cast<double>(turns);
    const double nearest = std::floor(quarters + 0.5);
    const double x = (quarters - nearest) * (std::numbers::pi / 2.0);
    const double x2 = x * x;
    const double s =
        x * (1.0 + x2 * (-1.0 / 6 +
                         x2 * (1.0 / 120 +
                               x2 * (-1.0 / 5040 +
                                     x2 * (1.0 / 362880 +
                                           x2 * (-1.0 / 39916800 + x2 * (1.0 / 6227020800.0)))))));
    const double c =
        1.0 +
        x2 * (-0.5 + x2 * (1.0 / 24 +
                           x2 * (-1.0 / 720 +
                                 x2 * (1.0 / 40320 + x2 * (-1.0 / 3628800 +
                                                           x2 * (1.0 / 479001600.0 -
                                                                 x2 * (1.0 / 87178291200.0)))))));
    const float sf = static_cast<float>(s), cf = static_cast<float>(c);
    switch (static_cast<int>(nearest) & 3) {
        case 0:
            return {sf, cf};
        case 1:
            return {cf, -sf};
        case 2:
            return {-sf, -cf};
        default:
            return {-cf, sf};
    }
}

// Binary logarithm of x > 0, normal; relative error below 1e-13 (series of the inverse hyperbolic
// tangent on [sqrt(1/2), sqrt(2)]).
inline double pinnedLog2(double x) {
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(x);
    int exponent = static_cast<int>(bits >> 52) - 1023;
    double m = std::bit_cast<double>((bits & 0x000fffffffffffffull) | 0x3ff0000000000000ull);
    if (m > std::numbers::sqrt2) {
        m *= 0.5;
        ++exponent;
    }
    const double s = (m - 1.0) / (m + 1.0);
    const double s2 = s * s;
    double sum = 1.0 / 17;
    for (const double divisor : {15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0})
        sum = sum * s2 + 1.0 / divisor;
    return exponent + 2.0 * s * sum * std::numbers::log2e;
}

// 2^x for x in [-1022, 1023]; relative error below 1e-13; 0 below the range.
inline double pinnedExp2(double x) {
    if (x < -1022.0) return 0.0;
    const double nearest = std::floor(x + 0.5);
    const double y = (x - nearest) * std::numbers::ln2;
    double sum = 1.0;
    for (const double divisor : {12.0, 11.0, 10.0, 9.0, 8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0})
        sum = sum * y / divisor + 1.0;
    const auto exponent = static_cast<std::uint64_t>(static_cast<std::int64_t>(nearest) + 1023);
    return sum * std::bit_cast<double>(exponent << 52);
}

// The angle from (1, 0) to (x, y), counter-clockwise, in turns: in [-1/2, 1/2]; 0 of (0, 0).
// Absolute error below 1e-13 (the angle halved twice, then the series of the inverse tangent).
inline double pinnedAtan2Turns(double y, double x) {
    const double ax = std::abs(x), ay = std::abs(y);
    const double larger = ax > ay ? ax : ay;
    if (!(larger > 0.0)) return 0.0;
    double t = (ax > ay ? ay : ax) / larger;
    for (int i = 0; i < 2; ++i) t /= 1.0 + std::sqrt(1.0 + t * t);
    double sum = 0.0;
    for (const double divisor : {17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0})
        sum = 1.0 / divisor - sum * t * t;
    const double eighth = 4.0 * t * sum / (2.0 * std::numbers::pi);
    const double quarter = ay > ax ? 0.25 - eighth : eighth;
    const double half = x < 0.0 ? 0.5 - quarter : quarter;
    return y < 0.0 ? -half : half;
}

// base^exponent for base in [0, 1] and exponent >= 0.
inline float pinnedPow(float base, float exponent) {
    if (exponent == 0.0f) return 1.0f;
    if (!(base > 0.0f)) return 0.0f;
    if (base < 1e-37f) base = 1e-37f;
    return static_cast<float>(
        pinnedExp2(static_cast<double>(exponent) * pinnedLog2(static_cast<double>(base))));
}

}  // namespace pm
