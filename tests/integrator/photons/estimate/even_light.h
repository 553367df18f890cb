// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <fmt/format.h>

#include <vector>

#include "integrator/photons/map/photon.h"
#include "tests/support/statistics.h"

namespace pm::test {

// Photons that make an irradiance of 1 on a parallelogram, one in each cell of a grid of so many
// rows and columns.
inline void light(std::vector<Photon>& photons, Vec3d p, Vec3d e0, Vec3d e1, std::uint64_t seed = 1,
                  int cells = 500) {
    Random random(seed);
    const Vec3d n = cross(e0, e1);
    const auto flux = static_cast<float>(length(n) / (cells * cells));
    for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
            const Vec2f u = random.next2D();
            photons.push_back({Vec3f(p + e0 * ((i + static_cast<double>(u.x)) / cells) +
                                     e1 * ((j + static_cast<double>(u.y)) / cells)),
                               Rgb(flux), PackedNormal(Vec3f(normalize(n)))});
        }
}

// Estimates of an irradiance of 1.
struct Estimates {
    double corrected = 0, narrow = 0, plain = 0;
    double worst = 0;  // a corrected one's distance from 1
};

inline void report(const char* where, const Estimates& e) {
    fmt::print("    {}: {:.3f} of E, at the narrow radius {:.3f}, uncorrected {:.3f}", where,
               e.corrected, e.narrow, e.plain);
    if (e.worst > 0) fmt::print(", worst {:.3f} off", e.worst);
    fmt::print("\n");
}

}  // namespace pm::test
