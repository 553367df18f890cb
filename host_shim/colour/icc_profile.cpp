// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/colour/icc_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace pm::host {
namespace {

using Bytes = std::span<const std::uint8_t>;
using Xyz = std::array<double, 3>;

// The profile connection space's white (ICC.1:2010, 7.2.16).
constexpr Xyz kD50{0.9642, 1.0, 0.8249};
// CIE 15: the inverse of lightness.
constexpr TransferCurve kLightness{3, 1 / 1.16, 0.16 / 1.16, 27 / 24.389, 0.08, 0, 0};
// ITU-R BT.709: the inverse of the camera's curve.
constexpr TransferCurve kCamera{1 / 0.45, 1 / 1.099, 0.099 / 1.099, 1 / 4.5, 0.081, 0, 0};

// 0 past the end.
std::uint32_t numberAt(Bytes bytes, std::size_t at, std::size_t size) {
    std::uint32_t number = 0;
    for (std::size_t i = at; i < at + size; ++i)
        number = number << 8 | (i < bytes.size() ? bytes[i] : 0u);
    return number;
}

double fixedAt(Bytes bytes, std::size_t at) {
    return static_cast<double>(static_cast<std::int32_t>(numberAt(bytes, at, 4))) / 65536;
}

bool isAt(Bytes bytes, std::size_t at, std::string_view signature) {
    return at + signature.size() <= bytes.size() &&
           std::equal(signature.begin(), signature.end(), bytes.begin() + static_cast<long>(at),
                      [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

// Empty where there is none.
Bytes tagOf(Bytes profile, std::string_view signature) {
    constexpr std::size_t kCount = 128, kFirst = 132, kEach = 12, kMost = 1000;
    const std::size_t count = std::min<std::size_t>(numberAt(profile, kCount, 4), kMost);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = kFirst + i * kEach;
        if (!isAt(profile, at, signature)) continue;
        const std::size_t offset = numberAt(profile, at + 4, 4),
                          size = numberAt(profile, at + 8, 4);
        if (offset > profile.size() || size > profile.size() - offset) return {};
        return profile.subspan(offset, size);
    }
    return {};
}

std::optional<TransferCurve> parametricCurve(Bytes tag) {
    constexpr std::array<std::size_t, 5> kParameters{1, 3, 4, 5, 7};
    const std::size_t type = numberAt(tag, 8, 2);
    if (type >= kParameters.size() || tag.size() < 12 + 4 * kParameters[type]) return std::nullopt;
    std::array<double, 7> p{};
    for (std::size_t i = 0; i < kParameters[type]; ++i) p[i] = fixedAt(tag, 12 + 4 * i);
    if (type == 0) return powerCurve(p[0]);
    if (type >= 3) return p;
    // Above where a x + b is 0 the power, below it a constant.
    if (p[1] == 0) return std::nullopt;
    const double constant = type == 2 ? p[3] : 0;
    return TransferCurve{p[0], p[1], p[2], 0, -p[2] / p[1], constant, constant};
}

// The formula whose values a table has, if there is one.
std::optional<TransferCurve> curveOfTable(Bytes tag, std::size_t count) {
    constexpr std::size_t kFirst = 12;
    if (tag.size() < kFirst + 2 * count) return std::nullopt;
    const auto entry = [&](std::size_t i) {
        return static_cast<double>(numberAt(tag, kFirst + 2 * i, 2)) / 65535;
    };
    const std::size_t middle = count / 2;
    const double code = static_cast<double>(middle) / static_cast<double>(count - 1);
    const double exponent = std::log(entry(middle)) / std::log(code);
    for (const TransferCurve& curve : {kSrgbCurve, kLightness, kCamera, powerCurve(exponent)}) {
        constexpr double kTolerance = 0.002;
        bool isIt = true;
        for (std::size_t i = 0; i < count && isIt; ++i) {
            const double light =
                lightOf(curve, static_cast<double>(i) / static_cast<double>(count - 1));
            isIt = std::fabs(light - entry(i)) <= kTolerance;
        }
        if (isIt) return curve;
    }
    return std::nullopt;
}

std::optional<TransferCurve> curveOf(Bytes tag) {
    if (isAt(tag, 0, "para")) return parametricCurve(tag);
    if (!isAt(tag, 0, "curv") || tag.size() < 12) return std::nullopt;
    const std::size_t count = numberAt(tag, 8, 4);
    if (count == 0) return powerCurve(1);
    if (count > 1) return count <= tag.size() ? curveOfTable(tag, count) : std::nullopt;
    return tag.size() < 14 ? std::nullopt : std::optional(powerCurve(numberAt(tag, 12, 2) / 256.0));
}

bool isSound(const TransferCurve& curve) {
    constexpr double kMost = 100;
    const auto bounded = [](double v) { return std::isfinite(v) && std::fabs(v) <= kMost; };
    return std::ranges::all_of(curve, bounded) && curve[0] > 0 &&
           std::fabs(lightOf(curve, 1) - 1) < 0.05;
}

std::optional<Xyz> columnOf(Bytes tag) {
    if (!isAt(tag, 0, "XYZ ") || tag.size() < 20) return std::nullopt;
    return Xyz{fixedAt(tag, 8), fixedAt(tag, 12), fixedAt(tag, 16)};
}

std::optional<Chromaticities> primariesOf(Bytes profile) {
    Chromaticities figures{};
    Xyz white{};
    std::size_t at = 0;
    for (const char* name : {"rXYZ", "gXYZ", "bXYZ"}) {
        const auto column = columnOf(tagOf(profile, name));
        if (!column) return std::nullopt;
        const double sum = (*column)[0] + (*column)[1] + (*column)[2];
        if (!(std::fabs(sum) > 1e-6)) return std::nullopt;
        figures[at++] = (*column)[0] / sum;
        figures[at++] = (*column)[1] / sum;
        for (std::size_t i = 0; i < 3; ++i) white[i] += (*column)[i];
    }
    // Whoever made other sums means another kind of profile.
    for (std::size_t i = 0; i < 3; ++i)
        if (!(std::fabs(white[i] - kD50[i]) < 0.02)) return std::nullopt;
    const double sum = kD50[0] + kD50[1] + kD50[2];
    figures[6] = kD50[0] / sum;
    figures[7] = kD50[1] / sum;
    return figures;
}

}  // namespace

std::optional<ProfileColours> readIccProfile(Bytes bytes) {
    constexpr std::size_t kSpace = 16, kConnection = 20, kMark = 36;
    if (!isAt(bytes, kMark, "acsp") || !isAt(bytes, kConnection, "XYZ ")) return std::nullopt;
    if (isAt(bytes, kSpace, "GRAY")) {
        const auto curve = curveOf(tagOf(bytes, "kTRC"));
        if (!curve || !isSound(*curve)) return std::nullopt;
        return ProfileColours{*curve, std::nullopt};
    }
    if (!isAt(bytes, kSpace, "RGB ")) return std::nullopt;
    const auto curve = curveOf(tagOf(bytes, "rTRC"));
    if (!curve || !isSound(*curve)) return std::nullopt;
    for (const char* name : {"gTRC", "bTRC"}) {
        const auto other = curveOf(tagOf(bytes, name));
        if (!other || !areAlike(*curve, *other)) return std::nullopt;
    }
    const auto primaries = primariesOf(bytes);
    if (!primaries) return std::nullopt;
    return ProfileColours{*curve, primaries};
}

}  // namespace pm::host
