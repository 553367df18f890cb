// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cmath>
#include <cstdint>

namespace pm {

// The unit that errors are judged in. relMSE is the mean over pixels and channels of
// (x - r)^2 / (r^2 + 0.01), and so what is darker than a tenth counts for less: right for a picture
// whose middle grey is 0.18, in whatever unit it comes. So x and r are taken times 2^stops, which
// is the same as an offset of 0.01 * 4^-stops. Everything that weighs noise against brightness
// takes its offset from here. A plain value; 0 stops unless told otherwise.
class ErrorScale {
  public:
    static constexpr std::int32_t kMostStops = 40;  // and as many down

    constexpr ErrorScale() = default;
    // stops: within +-kMostStops.
    constexpr explicit ErrorScale(std::int32_t stops) : m_stops(stops) {}

    constexpr std::int32_t stops() const { return m_stops; }
    // Of relMSE's denominator; the square of the unit of radiance.
    double offset() const { return std::ldexp(0.01, -2 * m_stops); }

    friend constexpr bool operator==(const ErrorScale&, const ErrorScale&) = default;

  private:
    std::int32_t m_stops = 0;
};

}  // namespace pm
