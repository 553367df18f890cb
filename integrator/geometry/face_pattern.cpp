// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/geometry/face_pattern.h"

#include <fmt/format.h>
#include <opensubdiv/bfr/parameterization.h>
#include <opensubdiv/bfr/tessellation.h>

#include <algorithm>
#include <cmath>

#include "integrator/geometry/quad_blocks.h"
#include "integrator/values/error.h"

namespace pm {

namespace {

namespace Bfr = OpenSubdiv::Bfr;
namespace Sdc = OpenSubdiv::Sdc;

Bfr::Parameterization parametersOf(SubdivisionScheme scheme, std::uint32_t faceSize) {
    constexpr Sdc::SchemeType kTypes[] = {Sdc::SCHEME_CATMARK, Sdc::SCHEME_LOOP,
                                          Sdc::SCHEME_BILINEAR};
    return {kTypes[static_cast<int>(scheme)], static_cast<int>(faceSize)};
}

Bfr::Tessellation tessellationOf(SubdivisionScheme scheme, EdgeRates rates) {
    return {parametersOf(scheme, static_cast<std::uint32_t>(rates.size())),
            static_cast<int>(rates.size()), rates.data()};
}

void checkValid(const Bfr::Tessellation& tessellation, EdgeRates rates) {
    if (tessellation.IsValid()) return;
    throw Error(Status::kInvalidScene,
                fmt::format("a face of {} corners can't be cut into pieces", rates.size()));
}

bool isInBlocks(SubdivisionScheme scheme, EdgeRates rates) {
    return scheme != SubdivisionScheme::kLoop && QuadBlocks::fit(rates);
}

}  // namespace

int mostPieces(SubdivisionScheme scheme, std::uint32_t faceSize) {
    if (faceSize == 4 && scheme != SubdivisionScheme::kLoop) return kMostPieces;
    // A face of n corners and r pieces an edge has about n r^2 / 2 triangles.
    constexpr double kMostTriangles = 16384;
    const double most = std::sqrt(2 * kMostTriangles / faceSize);
    return std::clamp(static_cast<int>(most), 1, kMostPiecesOfOthers);
}

std::uint32_t patternParts(SubdivisionScheme scheme, EdgeRates rates) {
    return isInBlocks(scheme, rates) ? QuadBlocks(rates).parts() : 1;
}

std::uint32_t patternTriangles(SubdivisionScheme scheme, EdgeRates rates, std::uint32_t part) {
    if (isInBlocks(scheme, rates)) return QuadBlocks(rates).triangles(part);
    const Bfr::Tessellation tessellation = tessellationOf(scheme, rates);
    checkValid(tessellation, rates);
    return static_cast<std::uint32_t>(tessellation.GetNumFacets());
}

void makePattern(SubdivisionScheme scheme, EdgeRates rates, std::uint32_t part,
                 FacePattern& pattern) {
    if (isInBlocks(scheme, rates)) return QuadBlocks(rates).make(part, pattern);
    pattern.clear();
    const Bfr::Tessellation tessellation = tessellationOf(scheme, rates);
    checkValid(tessellation, rates);
    std::vector<double> coords(2 * static_cast<std::size_t>(tessellation.GetNumCoords()));
    tessellation.GetCoords(coords.data());
    for (std::size_t i = 0; i < coords.size(); i += 2)
        pattern.points.push_back({{coords[i], coords[i + 1]}});
    // The boundary's come first, edge by edge.
    std::size_t at = 0;
    for (std::uint32_t edge = 0; edge < rates.size(); ++edge)
        for (int step = 0; step < rates[edge]; ++step, ++at) {
            pattern.points[at].edge = edge;
            pattern.points[at].step = static_cast<std::uint32_t>(step);
        }
    std::vector<int> facets(3 * static_cast<std::size_t>(tessellation.GetNumFacets()));
    tessellation.GetFacets(facets.data());
    for (std::size_t i = 0; i < facets.size(); i += 3)
        pattern.facets.push_back({static_cast<std::uint32_t>(facets[i]),
                                  static_cast<std::uint32_t>(facets[i + 1]),
                                  static_cast<std::uint32_t>(facets[i + 2])});
}

PatternDomain patternDomain(SubdivisionScheme scheme, EdgeRates rates, std::uint32_t part) {
    return isInBlocks(scheme, rates) ? QuadBlocks(rates).domain(part) : PatternDomain{};
}

std::array<double, 2> pointOfEdge(SubdivisionScheme scheme, std::uint32_t faceSize,
                                  std::uint32_t edge, double share) {
    std::array<double, 2> uv{};
    parametersOf(scheme, faceSize).GetEdgeCoord(static_cast<int>(edge), share, uv.data());
    return uv;
}

std::array<double, 2> middleOfFace(SubdivisionScheme scheme, std::uint32_t faceSize) {
    std::array<double, 2> uv{};
    parametersOf(scheme, faceSize).GetCenterCoord(uv.data());
    return uv;
}

}  // namespace pm
