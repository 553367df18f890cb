// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string_view>
#include <vector>

#include "host_shim/formats/pov/values/numbers.h"

namespace pm::host::pov {

enum class SplineKind { kLinear, kQuadratic, kCubic, kNatural };

// A way through points, one for each parameter.
struct Spline {
    struct Point {
        double parameter{};
        Numbers value;
    };

    SplineKind kind{SplineKind::kLinear};
    std::vector<Point> points;  // by their parameters

    // In place of one of the same parameter.
    void add(const Point& point);
    // Of as many components as the longest of its points. Outside, the nearest point; of cubic ones
    // the second and the one before the last. There has to be a point.
    Numbers at(double parameter, SplineKind as) const;
};

// Named as in the language, "linear_spline"; false: none of that name.
bool splineKindOf(std::string_view word, SplineKind& kind);
std::string_view wordOf(SplineKind kind);

}  // namespace pm::host::pov
