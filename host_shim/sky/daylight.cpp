// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/sky/daylight.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pm::host {
namespace {

constexpr double kPi = std::numbers::pi;

// CIE 1931 by wavelength, nm.
double lobe(double nm, double middle, double below, double above) {
    const double t = (nm - middle) * (nm < middle ? below : above);
    return std::exp(-0.5 * t * t);
}
Xyz matching(double nm) {
    return {0.362 * lobe(nm, 442.0, 0.0624, 0.0374) + 1.056 * lobe(nm, 599.8, 0.0264, 0.0323) -
                0.065 * lobe(nm, 501.1, 0.0490, 0.0382),
            0.821 * lobe(nm, 568.8, 0.0213, 0.0247) + 0.286 * lobe(nm, 530.9, 0.0613, 0.0322),
            1.217 * lobe(nm, 437.0, 0.0845, 0.0278) + 0.681 * lobe(nm, 459.0, 0.0385, 0.0725)};
}

// Irradiance by the sun above the atmosphere, W m^-2 nm^-1: Planck's law.
double sunSpectrum(double nm) {
    constexpr double kTemperature = 5778, kSolidAngle = 6.79e-5;
    constexpr double kFirst = 1.191043e-16, kSecond = 1.438777e-2;  // 2 h c^2, h c / k
    const double m = nm * 1e-9;
    const double radiance = kFirst / (m * m * m * m * m * std::expm1(kSecond / (m * kTemperature)));
    return radiance * kSolidAngle * 1e-9;
}

// Sum over the spectrum of the sun's light and what is left of it, klx.
template <typename Left>
Xyz throughAir(const Left& left) {
    constexpr double kStep = 5, kLumensOfWatt = 683.0;
    Xyz sum{};
    for (double nm = 380; nm <= 780; nm += kStep) {
        const Xyz seen = matching(nm);
        const double light = sunSpectrum(nm) * left(nm) * kStep * kLumensOfWatt * 1e-3;
        for (std::size_t i = 0; i < 3; ++i) sum[i] += seen[i] * light;
    }
    return sum;
}

double zenithChromaticity(const double (&m)[3][4], double t, double angle) {
    const double a = angle, powers[4] = {a * a * a, a * a, a, 1}, turbidity[3] = {t * t, t, 1};
    double sum = 0;
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 4; ++k) sum += turbidity[i] * m[i][k] * powers[k];
    return sum;
}

}  // namespace

double Daylight::Perez::at(double zenithAngle, double sunAngle) const {
    // At the horizon itself the first exponent has no end.
    const double cosine = std::max(std::cos(zenithAngle), 1e-3), sunCosine = std::cos(sunAngle);
    return (1 + c[0] * std::exp(c[1] / cosine)) *
           (1 + c[2] * std::exp(c[3] * sunAngle) + c[4] * sunCosine * sunCosine);
}

Daylight::Daylight(double elevation, double turbidity)
    : m_sunZenith(kPi / 2 - elevation), m_turbidity(turbidity) {
    const double t = turbidity;
    m_luminance = {{0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251,
                    0.1206 * t - 2.5771, -0.0670 * t + 0.3703}};
    m_x = {{-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989,
            -0.0033 * t + 0.0452}};
    m_y = {{-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537,
            -0.0109 * t + 0.0529}};
    const double chi = (4.0 / 9 - t / 120) * (kPi - 2 * m_sunZenith);
    m_zenithLuminance = (4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192;
    constexpr double kX[3][4] = {{0.00166, -0.00375, 0.00209, 0},
                                 {-0.02903, 0.06377, -0.03202, 0.00394},
                                 {0.11693, -0.21196, 0.06052, 0.25886}};
    constexpr double kY[3][4] = {{0.00275, -0.00610, 0.00317, 0},
                                 {-0.04214, 0.08970, -0.04153, 0.00516},
                                 {0.15346, -0.26756, 0.06670, 0.26688}};
    m_zenithX = zenithChromaticity(kX, t, m_sunZenith);
    m_zenithY = zenithChromaticity(kY, t, m_sunZenith);
}

Xyz Daylight::sky(double zenithAngle, double sunAngle) const {
    const auto at = [&](const Perez& perez, double ofZenith) {
        return ofZenith * perez.at(zenithAngle, sunAngle) / perez.at(0, m_sunZenith);
    };
    const double luminance = std::max(0.0, at(m_luminance, m_zenithLuminance));
    const double x = at(m_x, m_zenithX), y = at(m_y, m_zenithY);
    return {x / y * luminance, luminance, (1 - x - y) / y * luminance};
}

Xyz Daylight::sun() const {
    const double degrees = m_sunZenith * 180 / kPi;
    const double mass = 1 / (std::cos(m_sunZenith) + 0.15 * std::pow(93.885 - degrees, -1.253));
    const double beta = 0.04608 * m_turbidity - 0.04586;
    return throughAir([&](double nm) {
        const double micrometres = nm * 1e-3;
        return std::exp(
            -mass * (0.008735 * std::pow(micrometres, -4.08) + beta * std::pow(micrometres, -1.3)));
    });
}

Xyz Daylight::sunAbove() {
    return throughAir([](double) { return 1.0; });
}

std::array<double, 3> toRec709(const Xyz& c) {
    return {3.2404542 * c[0] - 1.5371385 * c[1] - 0.4985314 * c[2],
            -0.9692660 * c[0] + 1.8760108 * c[1] + 0.0415560 * c[2],
            0.0556434 * c[0] - 0.2040259 * c[1] + 1.0572252 * c[2]};
}

}  // namespace pm::host
