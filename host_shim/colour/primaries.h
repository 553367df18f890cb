// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <optional>
#include <string>

namespace pm::host {

using Matrix3 = std::array<double, 9>;         // row-major
using Chromaticities = std::array<double, 8>;  // x,y of red, green, blue, white

// Linear RGB of these primaries, white at luminance 1, to CIE XYZ adapted to D65 by Bradford's
// matrix.
Matrix3 rgbToXyzD65(const Chromaticities& chromaticities);
// ACES2065-1 to CIE XYZ adapted to D65.
Matrix3 acesToXyzD65();
Matrix3 multiply(const Matrix3& a, const Matrix3& b);

struct KnownSpace {
    std::string interopId;
    Chromaticities chromaticities;
};
// The well-known linear space that has this matrix to XYZ (D65), but for a rounding of its entries;
// none when there is none. The nearest two (Rec.709 and Adobe RGB) differ by 0.2.
std::optional<KnownSpace> recognise(const Matrix3& rgbToXyz, double tolerance = 1e-4);
// x,y of the columns, with D65's white; none when a column has no chromaticity.
std::optional<Chromaticities> derivedChromaticities(const Matrix3& rgbToXyz);

}  // namespace pm::host
