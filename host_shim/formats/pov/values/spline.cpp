// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/pov/values/spline.h"

#include <algorithm>
#include <array>
#include <utility>

namespace pm::host::pov {
namespace {

constexpr std::array<std::pair<std::string_view, SplineKind>, 4> kWords{{
    {"linear_spline", SplineKind::kLinear},
    {"quadratic_spline", SplineKind::kQuadratic},
    {"cubic_spline", SplineKind::kCubic},
    {"natural_spline", SplineKind::kNatural},
}};

using Points = std::vector<Spline::Point>;

// Of component c, between the points i and i + 1.
double linear(const Points& p, std::size_t i, std::size_t c, double t) {
    const double part = (t - p[i].parameter) / (p[i + 1].parameter - p[i].parameter);
    return p[i].value.at[c] + part * (p[i + 1].value.at[c] - p[i].value.at[c]);
}

// The parabola through the points i - 1, i and i + 1; Lagrange's form.
double quadratic(const Points& p, std::size_t i, std::size_t c, double t) {
    const std::size_t first = i == 0 ? 0 : i - 1;
    if (first + 2 >= p.size()) return linear(p, i, c, t);
    double sum = 0;
    for (std::size_t a = first; a < first + 3; ++a) {
        double term = p[a].value.at[c];
        for (std::size_t b = first; b < first + 3; ++b)
            if (b != a) term *= (t - p[b].parameter) / (p[a].parameter - p[b].parameter);
        sum += term;
    }
    return sum;
}

// Hermite's; the slope at a point is the mean of those of the chords beside it.
double cubic(const Points& p, std::size_t i, std::size_t c, double t) {
    const auto chord = [&](std::size_t at) {
        return (p[at + 1].value.at[c] - p[at].value.at[c]) /
               (p[at + 1].parameter - p[at].parameter);
    };
    const auto slope = [&](std::size_t at) { return (chord(at - 1) + chord(at)) / 2; };
    const double width = p[i + 1].parameter - p[i].parameter, s = (t - p[i].parameter) / width;
    const double s2 = s * s, s3 = s2 * s;
    return (2 * s3 - 3 * s2 + 1) * p[i].value.at[c] + (s3 - 2 * s2 + s) * width * slope(i) +
           (3 * s2 - 2 * s3) * p[i + 1].value.at[c] + (s3 - s2) * width * slope(i + 1);
}

// The second derivatives at the points of the cubic spline whose are 0 at its ends.
std::vector<double> bends(const Points& p, std::size_t c) {
    const std::size_t n = p.size();
    std::vector<double> second(n, 0.0), upper(n, 0.0);
    // Thomas' algorithm for the tridiagonal equations of inner points.
    for (std::size_t i = 1; i + 1 < n; ++i) {
        const double before = p[i].parameter - p[i - 1].parameter;
        const double behind = p[i + 1].parameter - p[i].parameter;
        const double right = 6 * ((p[i + 1].value.at[c] - p[i].value.at[c]) / behind -
                                  (p[i].value.at[c] - p[i - 1].value.at[c]) / before);
        const double pivot = 2 * (before + behind) - before * upper[i - 1];
        upper[i] = behind / pivot;
        second[i] = (right - before * second[i - 1]) / pivot;
    }
    for (std::size_t i = n - 1; i-- > 1;) second[i] -= upper[i] * second[i + 1];
    return second;
}

double natural(const Points& p, std::size_t i, std::size_t c, double t) {
    const std::vector<double> second = bends(p, c);
    const double width = p[i + 1].parameter - p[i].parameter;
    const double b = (t - p[i].parameter) / width, a = 1 - b;
    return a * p[i].value.at[c] + b * p[i + 1].value.at[c] +
           ((a * a * a - a) * second[i] + (b * b * b - b) * second[i + 1]) * width * width / 6;
}

}  // namespace

void Spline::add(const Point& point) {
    const auto at = std::ranges::lower_bound(points, point.parameter, {}, &Point::parameter);
    if (at != points.end() && at->parameter == point.parameter)
        *at = point;
    else
        points.insert(at, point);
}

Numbers Spline::at(double parameter, SplineKind as) const {
    std::size_t size = 2;
    for (const Point& point : points) size = std::max<std::size_t>(size, point.value.size);
    const std::size_t outer = as == SplineKind::kCubic && points.size() > 2 ? 1 : 0;
    const Point &first = points[outer], &last = points[points.size() - 1 - outer];
    if (!(parameter > first.parameter)) return first.value.promoted(size);
    if (!(parameter < last.parameter)) return last.value.promoted(size);
    const auto above = std::ranges::upper_bound(points, parameter, {}, &Point::parameter);
    const auto i = static_cast<std::size_t>(above - points.begin() - 1);
    static constexpr std::array kOf{linear, quadratic, cubic, natural};
    Numbers result;
    result.size = static_cast<std::uint8_t>(size);
    for (std::size_t c = 0; c < size; ++c)
        result.at[c] = kOf[static_cast<std::size_t>(as)](points, i, c, parameter);
    return result;
}

bool splineKindOf(std::string_view word, SplineKind& kind) {
    for (const auto& [text, of] : kWords)
        if (text == word) return kind = of, true;
    return false;
}

std::string_view wordOf(SplineKind kind) {
    return kWords[static_cast<std::size_t>(kind)].first;
}

}  // namespace pm::host::pov
