// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/shapes/copied_faces.h"

#include <algorithm>
#include <bit>
#include <tuple>
#include <utility>

namespace pm {
namespace {

using Corners = std::array<std::array<float, 3>, 3>;

Corners cornersOf(const PlacedFace& face) {
    Corners corners;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3f& p = face.corners[i];
        corners[i] = {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};  // -0 is 0
    }
    return corners;
}

// The same for the corners in any order.
std::uint64_t hashOf(const Corners& corners) {
    std::uint64_t sum = 0;
    for (const std::array<float, 3>& corner : corners) {
        std::uint64_t hash = 0;
        for (const float value : corner) {
            hash = (hash ^ std::bit_cast<std::uint32_t>(value)) * 0x9e3779b97f4a7c15u;
            hash ^= hash >> 29;
        }
        sum += hash * 0xbf58476d1ce4e5b9u;
    }
    return sum ^ sum >> 32;
}

struct Candidate {
    Corners corners;  // ordered
    bool isTurned;    // by that, to go round the other way
    PlacedFace face;

    explicit Candidate(const PlacedFace& placed) : corners(cornersOf(placed)), face(placed) {
        std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
        isTurned = corners[2] < corners[1];
        if (isTurned) std::swap(corners[1], corners[2]);
        const bool shines =
            face.kind == FaceKind::kShining || face.kind == FaceKind::kShiningMirrored;
        if (shines)
            isTurned = isTurned != (face.kind == FaceKind::kShiningMirrored);
        else
            isTurned = false;
        if (shines) face.kind = FaceKind::kShining;
    }
    auto kind() const { return std::tie(corners, face.kind, isTurned); }
    auto order() const {
        return std::tie(corners, face.kind, isTurned, face.shape, face.primitive);
    }
};

}  // namespace

std::vector<PlacedFace> findNeedlessCopies(
    std::uint64_t triangles, const std::function<void(const VisitFace&)>& forEachFace) {
    // How many there are of each hash, which few share by chance.
    const std::uint64_t buckets = std::bit_ceil(std::max<std::uint64_t>(1024, 4 * triangles));
    std::vector<std::uint8_t> counts(buckets);
    bool isAny = false;
    forEachFace([&](const PlacedFace& face) {
        std::uint8_t& count = counts[hashOf(cornersOf(face)) & (buckets - 1)];
        if (count <= kMostCopies) isAny |= ++count > kMostCopies;
    });
    if (!isAny) return {};
    std::vector<Candidate> candidates;
    forEachFace([&](const PlacedFace& face) {
        if (face.kind != FaceKind::kInvisible &&
            counts[hashOf(cornersOf(face)) & (buckets - 1)] > kMostCopies)
            candidates.emplace_back(face);
    });
    std::ranges::sort(candidates, {}, &Candidate::order);
    std::vector<PlacedFace> needless;
    for (auto first = candidates.begin(); first != candidates.end();) {
        const auto end = std::find_if(first, candidates.end(), [&](const Candidate& c) {
            return c.corners != first->corners;
        });
        for (auto i = first; i != end; ++i)
            if (static_cast<std::size_t>(end - first) > kMostCopies && i != first &&
                i->kind() == (i - 1)->kind())
                needless.push_back(i->face);
        first = end;
    }
    return needless;
}

}  // namespace pm
