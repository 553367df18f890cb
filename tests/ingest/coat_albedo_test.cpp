// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The means that Blender's coats are translated by, against the integrals that they stand for.
#include "host_shim/formats/mtl/coat_albedo.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace pm::host::test {
namespace {

constexpr int kViews = 24, kHeights = 48, kTurns = 16;

// Mean over views from everywhere (cosine-weighted) of what one view's directions bring; for each
// height u in [0,1] and turn phi, weight(cosine of the view, u, phi).
template <typename Weight>
double mean(const Weight& weight) {
    double sum = 0;
    for (int i = 0; i < kViews; ++i)
        for (int j = 0; j < kHeights; ++j)
            for (int k = 0; k < kTurns; ++k)
                sum += weight(std::sqrt((i + 0.5) / kViews), (j + 0.5) / kHeights,
                              std::numbers::pi * (k + 0.5) / kTurns);
    return sum / (kViews * kHeights * kTurns);
}

double fresnel(double cosine, double ior) {
    const double inside = std::sqrt(1 - (1 - cosine * cosine) / (ior * ior));
    const double parallel = (ior * cosine - inside) / (ior * cosine + inside);
    const double perpendicular = (cosine - ior * inside) / (cosine + ior * inside);
    return (parallel * parallel + perpendicular * perpendicular) / 2;
}

double lambda(double cosine, double alpha) {
    return (std::sqrt(1 + alpha * alpha * (1 / (cosine * cosine) - 1)) - 1) / 2;
}

// GGX with Smith's shadowing, by sampling half vectors.
double coat(double f0, double roughness) {
    const double ior = (1 + std::sqrt(f0)) / (1 - std::sqrt(f0)), alpha = roughness * roughness;
    return mean([&](double view, double u, double phi) {
        const double half = 1 / std::sqrt(1 + alpha * alpha * u / (1 - u));
        const double between =
            std::sqrt((1 - view * view) * (1 - half * half)) * std::cos(phi) + view * half;
        const double leaving = 2 * between * half - view;
        if (between <= 0 || leaving <= 0) return 0.0;
        const double shadow = 1 / (1 + lambda(view, alpha) + lambda(leaving, alpha));
        return fresnel(between, ior) * shadow * between / (view * half);
    });
}

double lobe(double exponent) {
    return mean([&](double view, double u, double phi) {
        const double cosine = std::pow(u, 1 / (exponent + 1));
        const double up =
            cosine * view + std::sqrt((1 - cosine * cosine) * (1 - view * view)) * std::cos(phi);
        return up > 0 ? (exponent + 2) / (exponent + 1) * up : 0;
    });
}

TEST(CoatAlbedo, IsTheIntegral) {
    for (const double roughness : {0.1, 0.25, 0.5, 0.75, 1.0}) {
        for (const double f0 : {0.02, 0.04, 0.08})
            EXPECT_NEAR(meanOfCoat(f0, roughness), coat(f0, roughness), 0.005)
                << f0 << " " << roughness;
        EXPECT_NEAR(meanOfLobe(roughness), lobe(exponentOfRoughness(roughness)), 0.01) << roughness;
    }
    EXPECT_NEAR(exponentOfRoughness(1), 0, 1e-9);
}

}  // namespace
}  // namespace pm::host::test
