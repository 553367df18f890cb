// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/colour/transfer_curve.h"

#include <cmath>

namespace pm::host {

double lightOf(const TransferCurve& curve, double code) {
    const auto& [g, a, b, c, d, e, f] = curve;
    const double inside = a * code + b;
    const double light = code < d ? c * code + f : (inside > 0 ? std::pow(inside, g) + e : e);
    return std::isfinite(light) ? light : 0.0;
}

bool areAlike(const TransferCurve& a, const TransferCurve& b) {
    constexpr int kSteps = 255;
    constexpr double kTolerance = 0.5 / kSteps;
    for (int i = 0; i <= kSteps; ++i) {
        const double code = static_cast<double>(i) / kSteps;
        if (!(std::fabs(lightOf(a, code) - lightOf(b, code)) <= kTolerance)) return false;
    }
    return true;
}

}  // namespace pm::host
