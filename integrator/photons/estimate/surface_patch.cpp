// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/estimate/surface_patch.h"

#include <algorithm>
#include <cmath>

#include "integrator/photons/estimate/surface_estimate.h"
#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// Rays that tell whether a patch is whole: on circles, radii in radii, an even number each. A hole
// as wide as a radius does not fit between them.
struct Circle {
    float radius;
    int rays;
};
constexpr std::array<Circle, 3> kCircles{{{1.85f, 14}, {1.4f, 12}, {0.9f, 8}}};
// What bends by more than this (14 degrees), or is farther off the plane, in radii, is not flat:
// its area is another than that of the plane behind it.
constexpr float kFlatCosine = 0.97f, kFlatHeight = 0.1f;
// Between a point and the site the surface bends evenly: the way is at right angles to the sum of
// both normals, within this, and within so many radii of rounding.
constexpr float kFlatness = 0.2f, kRounding = 1e-3f;
// The same of all that a whole patch shows. Across a fold sharper than this photons don't count for
// a point beside it: there the disc is not whole.
constexpr float kEvenness = 0.05f;
// Of a disc's radius, so much lies on the grid at least; what is beyond is not known.
constexpr float kReachOnGrid = 0.5f;
// How far off the plane, in radii, surface is looked for that is hidden.
constexpr float kHiddenHeight = 0.02f;
// Where in a row, from 0 to 1, chords of a disc stand for it (Gauss-Legendre, two nodes).
constexpr std::array<float, 2> kGaussNodes{0.21132487f, 0.78867513f};

PhotonGate gateAt(const Scene& scene, const Vec3f& position, const Vec3f& normal) {
    const float tolerance = PhotonGate::kRounding * scene.roundingRadius(position);
    return {position, normal, tolerance * tolerance};
}

}  // namespace

bool SurfacePatch::Place::isInside() const {
    constexpr auto side = static_cast<float>(kSquares);
    return x >= 0.0f && x < side && y >= 0.0f && y < side;
}

SurfacePatch::SurfacePatch(const Scene& scene, const Vec3f& position, const Vec3f& normal,
                           float radius, std::uint64_t pattern)
    : m_position(position),
      m_normal(normal),
      m_radius(radius),
      m_height(apexHeight(scene, position, normal, radius)),
      m_isAmongSheets(scene.hasSheets()),
      m_grid(std::make_unique<Grid>()) {
    m_apex = position + normal * m_height;
    const Frame frame(normal);
    m_grid->tangent = frame.tangent;
    m_grid->bitangent = frame.bitangent;
    const PhotonGate gate = gateAt(scene, position, normal);
    if (looksWhole(scene, gate)) {
        m_grid.reset();
    } else if (!measure(scene, gate, pattern)) {
        *this = {};
    }
}

SurfacePatch::Place SurfacePatch::placeOf(const Vec3f& position) const {
    const Vec3f fromSite = position - m_position;
    const float scale = kSquaresPerRadius / m_radius;
    return {kMiddle + dot(fromSite, m_grid->tangent) * scale,
            kMiddle + dot(fromSite, m_grid->bitangent) * scale};
}

Vec3f SurfacePatch::inPlane(Place place) const {
    return (m_grid->tangent * (place.x - kMiddle) + m_grid->bitangent * (place.y - kMiddle)) *
           (m_radius / kSquaresPerRadius);
}

SurfacePatch::Seen SurfacePatch::look(const Scene& scene, const PhotonGate& gate,
                                      Place towards) const {
    const SeenArea seen = lookFor(scene, gate, m_apex, inPlane(towards));
    if (!(seen.area > 0.0f)) return Seen::kNothing;
    return dot(seen.normal, m_normal) >= kFlatCosine &&
                   std::abs(dot(seen.fromPoint, m_normal)) <= kFlatHeight * m_radius
               ? Seen::kFlat
               : Seen::kBent;
}

bool SurfacePatch::bendsEvenly(const Vec3f& way, const Vec3f& normal, float within) const {
    const float height = dot(way, m_normal + normal);
    const float tolerance = kRounding * m_radius;
    return height * height <= within * within * lengthSquared(way) + tolerance * tolerance;
}

bool SurfacePatch::looksWhole(const Scene& scene, const PhotonGate& gate) {
    bool isPlane = true;
    for (const Circle& circle : kCircles) {
        const float reach = circle.radius * kSquaresPerRadius;
        for (int i = 0; i < circle.rays; ++i) {
            // Opposite sides first: an edge is on one of them.
            const int j = (i % 2) * (circle.rays / 2) + i / 2;
            const SinCos phi =
                sinCosTurns((static_cast<float>(j) + 0.5f) / static_cast<float>(circle.rays));
            const Place place{kMiddle + phi.cos * reach, kMiddle + phi.sin * reach};
            const SeenArea seen = lookFor(scene, gate, m_apex, inPlane(place));
            if (!(seen.area > 0.0f) || !bendsEvenly(seen.fromPoint, seen.normal, kEvenness))
                return false;
            isPlane = isPlane && gate.isInPlane(seen.fromPoint);
        }
    }
    m_isBesideSheets = isPlane && m_isAmongSheets;
    return true;
}

// Whether there is surface at a place of the plane where none was seen.
bool SurfacePatch::hides(const Scene& scene, const PhotonGate& gate, Place place) const {
    const float height = kHiddenHeight * m_radius;
    return lookFor(scene, gate, m_position + inPlane(place) + m_normal * height, inPlane(place))
               .area > 0.0f;
}

bool SurfacePatch::isInner(Place place) const {
    return place.isInside() && (m_grid->isInner[static_cast<std::size_t>(place.y)] >>
                                    static_cast<std::uint32_t>(place.x) &
                                1) != 0;
}

bool SurfacePatch::sees(const Scene& scene, const Vec3f& position, const Vec3f& normal) const {
    return isSeenFrom(scene, m_apex, position, normal);
}

bool SurfacePatch::speaksFor(const Scene& scene, const Vec3f& position, const Vec3f& normal,
                             float radius) const {
    if (!(dot(normal, m_normal) >= PhotonGate::kNormalCosine) ||
        !bendsEvenly(position - m_position, normal, kFlatness))
        return false;
    if (m_isAmongSheets) {
        const PhotonGate gate = gateAt(scene, m_position, m_normal);
        const Vec3f way = position - m_position;
        if (m_isBesideSheets ? !gate.isInPlane(way) : gate.isBesidePlane(way, normal)) return false;
    }
    if (isWhole()) return true;
    const Place place = placeOf(position);
    const float reach = kReachOnGrid * radius / m_radius * kSquaresPerRadius;
    return std::max(std::abs(place.x - kMiddle), std::abs(place.y - kMiddle)) <= kMiddle - reach &&
           ((!m_isAmongSheets && isInner(place)) || sees(scene, position, normal));
}

bool SurfacePatch::counts(const Scene& scene, const Photon& photon) const {
    return (!m_isAmongSheets && isInner(placeOf(photon.position))) ||
           sees(scene, photon.position, photon.normal.unpack());
}

TwoRadii SurfacePatch::countedFlux(const Scene& scene, const PhotonMap& map, const Vec3f& position,
                                   const Vec3f& normal, float radius, const TwoRadii& all) const {
    if (m_isBesideSheets) return map.fluxInPlane(position, normal, radius);
    if (!hidesSurface()) return all;
    return map.fluxWithin(position, normal, radius,
                          [&](std::uint32_t index) { return counts(scene, map.photon(index)); });
}

// Beyond the grid all is as at its border: past an edge there is nothing, away from it surface goes
// on. In squares.
float SurfacePatch::share(Place middle, float radius) const {
    const auto first = static_cast<std::int32_t>(std::floor(middle.y - radius));
    const auto last = static_cast<std::int32_t>(std::ceil(middle.y + radius));
    float area = 0.0f, disc = 0.0f;
    for (std::int32_t y = first; y < last; ++y) {
        const auto row = static_cast<std::size_t>(std::clamp(y, 0, kSquares - 1));
        const auto& areaUpTo = m_grid->areaUpTo[row];
        const auto upTo = [&](float x) {
            constexpr auto lastColumn = static_cast<float>(kSquares - 1);
            const auto column = static_cast<std::size_t>(std::clamp(x, 0.0f, lastColumn));
            return areaUpTo[column] +
                   (x - static_cast<float>(column)) * (areaUpTo[column + 1] - areaUpTo[column]);
        };
        // At the rim a row is crossed in part.
        const float top = std::max(static_cast<float>(y), middle.y - radius);
        const float height = std::min(static_cast<float>(y + 1), middle.y + radius) - top;
        for (const float inside : kGaussNodes) {
            const float away = top + inside * height - middle.y;
            const float half = std::sqrt(std::max(0.0f, radius * radius - away * away));
            area += height * (upTo(middle.x + half) - upTo(middle.x - half));
            disc += height * half;
        }
    }
    return disc > 0.0f ? std::max(kSmallestShare, 0.5f * area / disc) : 1.0f;
}

SurfacePatch::Shares SurfacePatch::shares(const Vec3f& position, float radius) const {
    if (isWhole()) return {};
    const Place middle = placeOf(position);
    const float squares = radius / m_radius * kSquaresPerRadius;
    return {share(middle, squares), share(middle, squares * std::sqrt(0.5f))};
}

}  // namespace pm
