// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Where the things of a sidecar stand.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "host_shim/formats/sidecar/sidecar_parts.h"

namespace pm::host {
namespace {

using Point = std::array<double, 3>;

double dot(const Point& a, const Point& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Point unit(const Point& a) {
    // Of directions that are very long or short too.
    const double length = std::hypot(a[0], a[1], a[2]);
    return {a[0] / length, a[1] / length, a[2] / length};
}

// Sine and cosine, exact for quarter turns.
std::array<double, 2> sineAndCosine(double degrees) {
    const double quarters = std::fmod(degrees, 360.0) / 90.0;
    constexpr double kSines[] = {0, 1, 0, -1};
    if (quarters == std::floor(quarters)) {
        const auto quarter = static_cast<unsigned>(static_cast<int>(quarters) + 4) % 4u;
        return {kSines[quarter], kSines[(quarter + 1) % 4]};
    }
    const double radians = degrees * std::numbers::pi / 180;
    return {std::sin(radians), std::cos(radians)};
}

}  // namespace

Transform rotationOf(const Point& degrees) {
    const auto [sx, cx] = sineAndCosine(degrees[0]);
    const auto [sy, cy] = sineAndCosine(degrees[1]);
    const auto [sz, cz] = sineAndCosine(degrees[2]);
    const Transform x{1, 0, 0, 0, 0, cx, -sx, 0, 0, sx, cx, 0};
    const Transform y{cy, 0, sy, 0, 0, 1, 0, 0, -sy, 0, cy, 0};
    const Transform z{cz, -sz, 0, 0, sz, cz, 0, 0, 0, 0, 1, 0};
    return product(z, product(y, x));
}

Transform lookingAlong(const Point& back, const Point& up, const Point& eye) {
    constexpr double kParallel = 1e-9;
    const Point z = unit(back);
    Point x = cross(unit(up), z);
    if (!(dot(x, x) > kParallel * kParallel))
        x = cross(std::abs(z[2]) < 0.9 ? Point{0, 0, 1} : Point{0, 1, 0}, z);
    x = unit(x);
    const Point y = cross(z, x);
    Transform transform{};
    for (std::size_t row = 0; row < 3; ++row) {
        transform[row * 4] = x[row];
        transform[row * 4 + 1] = y[row];
        transform[row * 4 + 2] = z[row];
        transform[row * 4 + 3] = eye[row];
    }
    return transform;
}

std::optional<Transform> readPlacement(const JsonPlace& at) {
    const bool isParts = at.has("translate") || at.has("rotate") || at.has("scale");
    if (at.has("matrix")) {
        if (isParts)
            at.refuse(" has a matrix and one of translate, rotate and scale; it is either");
        return at.member("matrix").matrix();
    }
    if (!isParts) return std::nullopt;
    const Point by = at.has("translate") ? at.member("translate").triple() : Point{};
    Point scale{1, 1, 1};
    if (at.has("scale")) {
        const JsonPlace place = at.member("scale");
        scale = place.oneOrThree();
        for (const double factor : scale)
            if (factor == 0) place.refuse(" is 0; it must not flatten space");
    }
    Transform transform = kIdentity;
    if (at.has("rotate")) transform = rotationOf(at.member("rotate").triple());
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t i = 0; i < 3; ++i) transform[row * 4 + i] *= scale[i];
        transform[row * 4 + 3] = by[row];
    }
    return transform;
}

Transform readRotation(const JsonPlace& at) {
    const Transform m = at.matrix();
    constexpr double kTolerance = 1e-4;  // as the C interface has it
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = i; j < 3; ++j) {
            const double sum = m[i] * m[j] + m[4 + i] * m[4 + j] + m[8 + i] * m[8 + j];
            if (!(std::abs(sum - (i == j ? 1 : 0)) <= kTolerance))
                at.refuse(" stretches or shears; it must be a rotation and a translation");
        }
    }
    return m;
}

}  // namespace pm::host
