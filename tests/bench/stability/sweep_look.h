// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Small frames that sweeps render, and what is counted in them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/scene_maker.h"

namespace pm::bench {

// How a scene is looked at.
struct Look {
    IntegratorKind integrator = IntegratorKind::kPhoton;
    std::uint64_t seed = 1;
    std::int32_t size = 16;    // pixels of a side
    std::uint32_t passes = 1;  // of 4 samples a pixel
    std::uint64_t photons = 5'000;
    std::uint32_t estimatePhotons = 50;
};

// Means over a frame, of the green channel.
struct Seen {
    double beauty = 0, direct = 0, indirect = 0, caustic = 0, emission = 0;
    std::vector<double> pixels;  // the beauty's, row by row
    RenderCounters counters;

    // Pixels that are off by more than rounding, and values that were no number.
    double countOff(double expected) const;
};

// Passes of a scene that is cheap for both: paths need more of them.
constexpr std::uint32_t manyPasses(IntegratorKind integrator) {
    return integrator == IntegratorKind::kPhoton ? 4 : 32;
}

Seen look(const test::SceneMaker& maker, const Look& how);

// photon or path, for Sweep::variant.
std::string nameOf(IntegratorKind integrator);
inline constexpr IntegratorKind kBoth[] = {IntegratorKind::kPhoton, IntegratorKind::kPath};

// The same scene scaled about the origin and then moved: by its instances' transforms, which are
// double, so that no corner is rounded. Lights at points grow with it.
test::SceneMaker placed(test::SceneMaker maker, double scale, const Vec3d& offset);

// Irradiance, W m^-2, at the origin of a surface that faces along `normal`, from a polygon of
// radiance 1 above its horizon. Source: Lambert 1760.
double polygonIrradiance(const std::vector<Vec3d>& corners, const Vec3d& normal);

// What glass of an index reflects, the mean of both polarisations; cosine: outside, to the normal.
double fresnel(double index, double cosine);

}  // namespace pm::bench
