// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>

namespace pm::host {

using Xyz = std::array<double, 3>;  // CIE 1931, Y photometric

// A clear sky by day. Source: Preetham, Shirley & Smits, "A Practical Analytic Model for Daylight",
// SIGGRAPH 1999: Perez' distribution with their fits for luminance and chromaticity; the sun by a
// black body of 5778 K outside of the atmosphere, and in it their Rayleigh and aerosol terms.
// Colour matching: Wyman, Sloan & Shirley, JCGT 2(2), 2013 (the fit of several lobes).
class Daylight {
  public:
    static constexpr double kLeastTurbidity = 1.7, kMostTurbidity = 10.0;
    static constexpr double kSunRadius = 0.00465;  // of its disc, radians

    // elevation: of the sun, radians, in (0, pi/2]; turbidity: 2 is very clear, 6 hazy.
    Daylight(double elevation, double turbidity);

    // Luminance of the sky, kcd/m^2. zenithAngle: radians, in [0, pi/2]; sunAngle: to the sun.
    Xyz sky(double zenithAngle, double sunAngle) const;
    // Illuminance of a surface that faces the sun, by the sun alone, klx.
    Xyz sun() const;
    // The same outside of the atmosphere.
    static Xyz sunAbove();

  private:
    struct Perez {
        std::array<double, 5> c;
        double at(double zenithAngle, double sunAngle) const;
    };

    double m_sunZenith, m_turbidity;
    Perez m_luminance, m_x, m_y;
    double m_zenithLuminance, m_zenithX, m_zenithY;
};

// Linear Rec.709 with white D65; channels may be below 0.
std::array<double, 3> toRec709(const Xyz& xyz);

}  // namespace pm::host
