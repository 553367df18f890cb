// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// How a face is sampled whose edges are each cut into as many pieces as they ask for. A large quad
// is sampled part by part, so that no part has more triangles than a few thousand.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "integrator/geometry/polygon_mesh.h"
#include "integrator/geometry/subdivision.h"

namespace pm {

// A point of a face, and of which of its edges it is: `step` of as many pieces from the edge's
// beginning, as the face runs along it.
struct PatternPoint {
    static constexpr std::uint32_t kInside = 0xffffffffu;

    std::array<double, 2> uv{};
    std::uint32_t edge = kInside;
    std::uint32_t step = 0;  // 0: at the corner where the edge begins
};

// Reusable; `facets` are numbers of `points`, counterclockwise seen from the front.
struct FacePattern {
    std::vector<PatternPoint> points;
    std::vector<TriangleMesh::Corners> facets;

    void clear() {
        points.clear();
        facets.clear();
    }
};

// The pieces that each edge of a face is cut into, at least 1; in the order of its corners.
using EdgeRates = std::span<const int>;

// The most pieces of an edge: where all of its faces are quads under Catmull-Clark or bilinear
// subdivision, and of others. A face of many corners asks for less: mostPieces().
inline constexpr int kMostPieces = 1024, kMostPiecesOfOthers = 64;
int mostPieces(SubdivisionScheme scheme, std::uint32_t faceSize);

std::uint32_t patternParts(SubdivisionScheme scheme, EdgeRates rates);
std::uint32_t patternTriangles(SubdivisionScheme scheme, EdgeRates rates, std::uint32_t part);

// In place of what the pattern held. Neighbouring parts have points in common with equal numbers.
// Threads: any.
void makePattern(SubdivisionScheme scheme, EdgeRates rates, std::uint32_t part,
                 FacePattern& pattern);

// Of the face's parameters: the rectangle that a part of a quad lies in; all of it for others.
struct PatternDomain {
    std::array<double, 2> lo{0, 0}, hi{1, 1};
};
PatternDomain patternDomain(SubdivisionScheme scheme, EdgeRates rates, std::uint32_t part);

// A point of a face's edge, `share` of the way along it; the face's middle.
std::array<double, 2> pointOfEdge(SubdivisionScheme scheme, std::uint32_t faceSize,
                                  std::uint32_t edge, double share);
std::array<double, 2> middleOfFace(SubdivisionScheme scheme, std::uint32_t faceSize);

}  // namespace pm
