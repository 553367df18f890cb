// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// How a patch that is not whole gets its grid.
#include <algorithm>
#include <optional>
#include <utility>

#include "integrator/photons/estimate/surface_patch.h"
#include "integrator/sampling/sampler.h"

namespace pm {

namespace {

// Halvings of the way from where there is surface to where there is none: the edge is there.
constexpr int kHalvings = 3;
// A square at least so full has no edge, but perhaps at its rim.
constexpr float kFull = 0.999f;

// The unit square's corners, around.
constexpr std::array<Vec2f, 4> kCorners{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

Vec2f between(const Vec2f& a, const Vec2f& b, float part) {
    return {a.x + (b.x - a.x) * part, a.y + (b.y - a.y) * part};
}

// The middle of those corners that are flat, or of those that are not; one is, at least.
Vec2f middleOf(const std::array<bool, 4>& isFlat, bool wanted) {
    Vec2f sum{};
    float count = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        if (isFlat[i] != wanted) continue;
        sum = {sum.x + kCorners[i].x, sum.y + kCorners[i].y};
        ++count;
    }
    return {sum.x / count, sum.y / count};
}

// Area of the unit square that is flat, where an edge goes by way of `inside` from side to side
// (marching squares: Lorensen & Cline 1987 in two dimensions). From the corner at the origin on,
// around: whether the corners are flat, and the part that is of the side to the next.
float flatArea(const std::array<bool, 4>& isFlat, const std::array<float, 4>& parts,
               const Vec2f& inside) {
    std::array<Vec2f, 10> outline;
    std::size_t count = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t next = (i + 1) % 4;
        if (isFlat[i]) outline[count++] = kCorners[i];
        if (isFlat[i] == isFlat[next]) continue;
        outline[count++] =
            between(kCorners[i], kCorners[next], isFlat[i] ? parts[i] : 1.0f - parts[i]);
        if (isFlat[i]) outline[count++] = inside;
    }
    float twice = 0.0f;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec2f &a = outline[i], &b = outline[(i + 1) % count];
        twice += a.x * b.y - b.x * a.y;
    }
    return 0.5f * twice;
}

}  // namespace

// Rays to the squares' corners (nodes), from coarse to fine, and to where the edge goes through
// squares whose corners are unlike.
class SurfacePatch::Survey {
  public:
    Survey(const SurfacePatch& patch, const Scene& scene, const PhotonGate& gate,
           std::uint64_t pattern)
        : m_patch(patch), m_scene(scene), m_gate(gate), m_random(pattern) {}

    // False where what is seen isn't flat, or the site itself is not seen.
    bool fill(Grid& grid) {
        if (!lookAtNodes() || !findSides()) return false;
        for (std::uint32_t y = 0; y < kSquares; ++y) {
            auto& row = grid.areaUpTo[y];
            row[0] = 0.0f;
            for (std::uint32_t x = 0; x < kSquares; ++x) {
                const std::optional<float> area = areaOf(y * kNodes + x);
                if (!area) return false;
                row[x + 1] = row[x] + *area;
            }
        }
        findInner(grid);
        grid.hasHidden = hasHidden();
        return true;
    }

  private:
    static constexpr std::uint32_t kNodes = kSquares + 1;
    static constexpr std::size_t kCount = std::size_t{kNodes} * kNodes;

    bool lookAt(std::uint32_t node);
    bool lookAtNodes();
    bool lookAtBlocks();
    bool findSides();
    std::optional<float> flatPart(std::uint32_t a, std::uint32_t b);
    std::optional<float> edgeBetween(const Vec2f& from, const Vec2f& to);
    std::optional<float> areaOf(std::uint32_t node);
    bool hasHidden() const;
    static void findInner(Grid& grid);
    static Vec2f placeOf(std::uint32_t node) {
        return {static_cast<float>(node % kNodes), static_cast<float>(node / kNodes)};
    }

    const SurfacePatch& m_patch;
    const Scene& m_scene;
    const PhotonGate& m_gate;
    std::uint64_t m_random;
    // What the nodes show, row by row, and whether a ray told so; else those around do.
    std::array<Seen, kCount> m_seen;
    std::array<bool, kCount> m_isLookedAt{};
    // The flat part of the way to the next node, rightwards and downwards.
    std::array<float, kCount> m_right, m_down;
};

bool SurfacePatch::measure(const Scene& scene, const PhotonGate& gate, std::uint64_t pattern) {
    return Survey(*this, scene, gate, pattern).fill(*m_grid);
}

// False where what is seen isn't flat.
bool SurfacePatch::Survey::lookAt(std::uint32_t node) {
    if (m_isLookedAt[node]) return true;
    m_isLookedAt[node] = true;
    const Vec2f place = placeOf(node);
    m_seen[node] = m_patch.look(m_scene, m_gate, {place.x, place.y});
    return m_seen[node] != Seen::kBent;
}

// Every other node along both axes; the others are taken to be as those.
bool SurfacePatch::Survey::lookAtNodes() {
    for (std::uint32_t y = 0; y < kNodes; y += 2)
        for (std::uint32_t x = 0; x < kNodes; x += 2)
            if (!lookAt(y * kNodes + x)) return false;
    static_assert(kSquares % 4 == 0, "one of these lies in the middle");
    if (m_seen[kCount / 2] != Seen::kFlat) return false;
    for (std::uint32_t i = 0; i < kCount; ++i)
        m_seen[i] = m_seen[(i / kNodes & ~1u) * kNodes + (i % kNodes & ~1u)];
    return lookAtBlocks();
}

// All nodes of the blocks of 2 x 2 squares whose corners, or those of a block beside, are unlike.
bool SurfacePatch::Survey::lookAtBlocks() {
    constexpr std::uint32_t blocks = kSquares / 2;
    std::array<bool, blocks * blocks> isMixed;
    for (std::uint32_t b = 0; b < blocks * blocks; ++b) {
        const Seen* const corner = &m_seen[b / blocks * 2 * kNodes + b % blocks * 2];
        isMixed[b] = corner[2] != *corner || corner[2 * kNodes] != *corner ||
                     corner[2 * kNodes + 2] != *corner;
    }
    for (std::uint32_t b = 0; b < blocks * blocks; ++b) {
        const std::uint32_t x = b % blocks, y = b / blocks;
        bool isNear = false;
        for (std::uint32_t v = y - (y > 0); v <= std::min(y + 1, blocks - 1); ++v)
            for (std::uint32_t u = x - (x > 0); u <= std::min(x + 1, blocks - 1); ++u)
                isNear = isNear || isMixed[v * blocks + u];
        for (std::uint32_t k = 0; isNear && k < 9; ++k)
            if (!lookAt((2 * y + k / 3) * kNodes + 2 * x + k % 3)) return false;
    }
    return true;
}

bool SurfacePatch::Survey::findSides() {
    for (std::uint32_t i = 0; i < kCount; ++i) {
        const auto right = i % kNodes + 1 < kNodes ? flatPart(i, i + 1) : 0.0f;
        const auto down = i / kNodes + 1 < kNodes ? flatPart(i, i + kNodes) : 0.0f;
        if (!right || !down) return false;
        m_right[i] = *right;
        m_down[i] = *down;
    }
    return true;
}

// Of the way between two nodes the part that is flat surface.
std::optional<float> SurfacePatch::Survey::flatPart(std::uint32_t a, std::uint32_t b) {
    if (m_seen[a] == m_seen[b]) return m_seen[a] == Seen::kFlat ? 1.0f : 0.0f;
    if (m_seen[a] != Seen::kFlat) std::swap(a, b);
    return edgeBetween(placeOf(a), placeOf(b));
}

// How far from a place that is flat to one that isn't there the edge lies, over the way; nothing
// where what is met isn't flat. The places looked at are shifted at random, so that along a
// straight edge the rounding is not everywhere the same: its mean is 0.
std::optional<float> SurfacePatch::Survey::edgeBetween(const Vec2f& from, const Vec2f& to) {
    constexpr float kSteps = 1 << kHalvings, kStep = 1.0f / (kSteps - 1.0f);
    const float shift = toUnitFloat(static_cast<std::uint32_t>(mixBits(m_random++)));
    float flat = (shift - 1.0f) * kStep, nothing = flat + kSteps * kStep;
    for (int i = 0; i < kHalvings; ++i) {
        const float middle = 0.5f * (flat + nothing);
        const Vec2f place = between(from, to, middle);
        const Seen seen = m_patch.look(m_scene, m_gate, {place.x, place.y});
        if (seen == Seen::kBent) return std::nullopt;
        (seen == Seen::kFlat ? flat : nothing) = middle;
    }
    return 0.5f * (flat + nothing);
}

// Of a square, by its first node; nothing where what is met isn't flat.
std::optional<float> SurfacePatch::Survey::areaOf(std::uint32_t node) {
    const std::array<std::uint32_t, 4> corners{node, node + 1, node + kNodes + 1, node + kNodes};
    const std::array<float, 4> parts{m_right[node], m_down[node + 1], m_right[node + kNodes],
                                     m_down[node]};
    std::array<bool, 4> isFlat;
    int count = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        isFlat[i] = m_seen[corners[i]] == Seen::kFlat;
        count += isFlat[i];
    }
    if (count == 0 || count == 4) return static_cast<float>(count == 4);
    // Two that face each other across the square: straight lines cut them off.
    if (count == 2 && isFlat[0] == isFlat[2])
        return 0.5f * (isFlat[0] ? parts[0] * parts[3] + parts[1] * parts[2]
                                 : parts[0] * parts[1] + parts[2] * parts[3]);
    // A corner of the surface may lie within: how far does it reach?
    const Vec2f from = middleOf(isFlat, true), to = middleOf(isFlat, false), first = placeOf(node);
    const std::optional<float> part =
        edgeBetween({first.x + from.x, first.y + from.y}, {first.x + to.x, first.y + to.y});
    if (!part) return std::nullopt;
    return flatArea(isFlat, parts, between(from, to, *part));
}

// Whether there is surface where none was seen.
bool SurfacePatch::Survey::hasHidden() const {
    for (std::uint32_t i = 0; i < kCount; ++i) {
        if (!m_isLookedAt[i] || m_seen[i] != Seen::kNothing) continue;
        const Vec2f place = placeOf(i);
        if (m_patch.hides(m_scene, m_gate, {place.x, place.y})) return true;
    }
    return false;
}

// Beyond the grid's border nothing speaks against a square.
void SurfacePatch::Survey::findInner(Grid& grid) {
    constexpr std::uint32_t all = (std::uint32_t{1} << kSquares) - 1;
    // Full squares whose neighbours in the row are full, too.
    std::array<std::uint32_t, kSquares + 2> inRow;
    inRow.front() = inRow.back() = all;
    for (std::size_t y = 0; y < kSquares; ++y) {
        const auto& row = grid.areaUpTo[y];
        std::uint32_t full = 0;
        for (std::size_t x = 0; x < kSquares; ++x)
            full |= std::uint32_t{row[x + 1] - row[x] >= kFull} << x;
        inRow[y + 1] = full & (full << 1 | 1) & (full >> 1 | (all + 1) >> 1);
    }
    for (std::size_t y = 0; y < kSquares; ++y)
        grid.isInner[y] = inRow[y] & inRow[y + 1] & inRow[y + 2];
}

}  // namespace pm
