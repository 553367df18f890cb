// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Matrices between linear RGB spaces and CIE XYZ, from published primaries.
// [1] SMPTE RP 177, "Derivation of basic television color equations"
// [2] Lam, "Metamerism and colour constancy" (1985): the Bradford matrix
// [3] SMPTE ST 2065-1, Academy TB-2014-004 and S-2014-004 (AP0, AP1, the ACES white)
#include "host_shim/colour/primaries.h"

#include <cmath>

namespace pm::host {
namespace {

using Vector = std::array<double, 3>;

constexpr std::array<double, 2> kD65{0.3127, 0.3290};
constexpr Matrix3 kBradford{0.8951, 0.2664, -0.1614, -0.7502, 1.7135,
                            0.0367, 0.0389, -0.0685, 1.0296};
constexpr Chromaticities kAp0{0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767};

Vector xyzOf(double x, double y) {
    return {x / y, 1.0, (1.0 - x - y) / y};
}

Vector transformed(const Matrix3& m, const Vector& v) {
    return {m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
            m[6] * v[0] + m[7] * v[1] + m[8] * v[2]};
}

Matrix3 inverse(const Matrix3& m) {
    const Matrix3 adjugate{
        m[4] * m[8] - m[5] * m[7], m[2] * m[7] - m[1] * m[8], m[1] * m[5] - m[2] * m[4],
        m[5] * m[6] - m[3] * m[8], m[0] * m[8] - m[2] * m[6], m[2] * m[3] - m[0] * m[5],
        m[3] * m[7] - m[4] * m[6], m[1] * m[6] - m[0] * m[7], m[0] * m[4] - m[1] * m[3]};
    const double determinant = m[0] * adjugate[0] + m[1] * adjugate[3] + m[2] * adjugate[6];
    Matrix3 result{};
    for (std::size_t i = 0; i < 9; ++i) result[i] = adjugate[i] / determinant;
    return result;
}

// [1]: the columns are the primaries, scaled so that (1,1,1) is the white.
Matrix3 rgbToXyz(const Chromaticities& c) {
    Matrix3 columns{};
    for (std::size_t primary = 0; primary < 3; ++primary) {
        const double x = c[2 * primary], y = c[2 * primary + 1];
        columns[primary] = x;
        columns[3 + primary] = y;
        columns[6 + primary] = 1.0 - x - y;
    }
    const Vector scale = transformed(inverse(columns), xyzOf(c[6], c[7]));
    for (std::size_t i = 0; i < 9; ++i) columns[i] *= scale[i % 3];
    return columns;
}

// [2]: XYZ under one white to XYZ under another.
Matrix3 adaptation(const Vector& from, const Vector& to) {
    const Vector source = transformed(kBradford, from), target = transformed(kBradford, to);
    const Matrix3 gain{target[0] / source[0], 0, 0, 0, target[1] / source[1], 0, 0, 0,
                       target[2] / source[2]};
    return multiply(inverse(kBradford), multiply(gain, kBradford));
}

const std::array<KnownSpace, 6>& knownSpaces() {
    static const std::array<KnownSpace, 6> kSpaces{{
        {"lin_rec709_scene", {0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290}},
        {"lin_ap1_scene", {0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767}},
        {"lin_ap0_scene", kAp0},
        {"lin_rec2020_scene", {0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290}},
        {"lin_p3d65_scene", {0.680, 0.320, 0.265, 0.690, 0.150, 0.060, 0.3127, 0.3290}},
        {"lin_adobergb_scene", {0.64, 0.33, 0.21, 0.71, 0.15, 0.06, 0.3127, 0.3290}},
    }};
    return kSpaces;
}

}  // namespace

Matrix3 multiply(const Matrix3& a, const Matrix3& b) {
    Matrix3 result{};
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 3; ++column) {
            for (std::size_t k = 0; k < 3; ++k) {
                result[row * 3 + column] += a[row * 3 + k] * b[k * 3 + column];
            }
        }
    }
    return result;
}

Matrix3 rgbToXyzD65(const Chromaticities& c) {
    return multiply(adaptation(xyzOf(c[6], c[7]), xyzOf(kD65[0], kD65[1])), rgbToXyz(c));
}

Matrix3 acesToXyzD65() {
    return rgbToXyzD65(kAp0);
}

std::optional<KnownSpace> recognise(const Matrix3& matrix, double tolerance) {
    for (const KnownSpace& space : knownSpaces()) {
        const Matrix3 known = rgbToXyzD65(space.chromaticities);
        double largest = 0.0;
        for (std::size_t i = 0; i < 9; ++i) {
            largest = std::fmax(largest, std::fabs(known[i] - matrix[i]));
        }
        if (largest < tolerance) return space;
    }
    return std::nullopt;
}

std::optional<Chromaticities> derivedChromaticities(const Matrix3& m) {
    Chromaticities result{};
    for (std::size_t primary = 0; primary < 3; ++primary) {
        const double sum = m[primary] + m[3 + primary] + m[6 + primary];
        result[2 * primary] = m[primary] / sum;
        result[2 * primary + 1] = m[3 + primary] / sum;
        if (!std::isfinite(result[2 * primary]) || !std::isfinite(result[2 * primary + 1])) {
            return std::nullopt;
        }
    }
    result[6] = kD65[0];
    result[7] = kD65[1];
    return result;
}

}  // namespace pm::host
