// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "integrator/values/vec.h"

namespace pm {

enum class FaceKind : std::uint8_t {
    kOpaque,
    kSheet,
    kGlass,
    kShining,
    kShiningMirrored,
    kInvisible
};

// A triangle in the scene.
struct PlacedFace {
    std::array<Vec3f, 3> corners;
    FaceKind kind;
    std::uint32_t shape, primitive;
};
using VisitFace = std::function<void(const PlacedFace&)>;

// So many exact copies of a triangle are left alone.
inline constexpr std::size_t kMostCopies = 8;

// Where many triangles are exact copies of each other, no ray is to meet more than a few: each
// would be tried by each ray that comes near, for nothing. Returns, of those with the same three
// corners, if they are more than kMostCopies, all but one of each kind (shining to one side and to
// the other are two): the first of the scene, which is the one that is seen by the rule for faces
// that lie on others (coincident_faces.h). forEachFace: calls what it is given for all faces, in
// the scene's order; it is asked twice where there may be such, and what it throws comes through.
std::vector<PlacedFace> findNeedlessCopies(
    std::uint64_t triangles, const std::function<void(const VisitFace&)>& forEachFace);

}  // namespace pm
