// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <compare>
#include <cstdint>
#include <memory>
#include <span>
#include <tuple>
#include <vector>

#include "integrator/scene/scene.h"

namespace pm {

// Lamps that lie in their ceiling's plane, glass that stands exactly on a floor: rays meet both
// within roundings, and which one is told would be chance. Here it is a rule: a lamp that shines
// towards the ray before what is opaque, that before what is half transparent, and that before
// glass, so that light that has come through glass is on the floor and not beyond it; of two alike
// the first in the scene.
//
// The two sides of a pane that is too thin to start rays in are met as one, with what both do to
// light. Of bodies of glass with unlike priorities that of the higher one is met, which is there on
// the inner side. Opaque faces that lie on opaque ones are not looked for.
class Scene::CoincidentFaces {
  public:
    // Null where there are none. Adds a notice for those that no rule helps. Searches in parallel
    // in the calling TBB arena: rays through points of all lamps' and glasses' triangles, at least
    // one each, more where there are few. Throws Error(kCancelled).
    static std::unique_ptr<const CoincidentFaces> find(const Scene& scene,
                                                       std::vector<Notice>& notices,
                                                       const CancelCheck& cancel);

    // What the ray, whose nearest hit is given, meets by that rule. Threads: any, at once.
    RayHit chosen(const Ray& ray, const RayHit& nearest) const;

    // How far behind its near side the far side of such a pane is at most, in the offsets of rays
    // that leave it (Surface::offset), and how many of these are surely beyond.
    static constexpr float kThickestPane = 4.0f, kBeyondPane = 6.0f;

    std::uint64_t memoryBytes() const;

  private:
    struct Face {
        std::uint32_t shape, primitive;
        auto operator<=>(const Face&) const = default;
    };
    struct Found;
    using Order = std::tuple<int, std::int32_t, Face>;  // rank, priority of bodies of glass
    enum class Rank : std::uint8_t { kGlass, kSheet, kOpaque, kShining };

    CoincidentFaces(const Scene& scene, const std::vector<Face>& faces);
    static Rank rankOf(const Scene& scene, const Face& face);
    static bool isOn(const Scene& scene, const Face& face, const Surface& point);
    // Behind the plane of a face, how far another is; scene units, below 0 before it.
    static double depthBehind(const Scene& scene, const Face& face, const Face& other);
    // Whether they are the two sides of one body of clear glass, with nothing but it between them.
    static bool areOfPane(const Scene& scene, const Face& face, const Face& other);
    // Whether they lie beside each other, with an edge in common.
    static bool areNeighbours(const Scene& scene, const Face& face, const Face& other);
    // Whether they let light through by the same picture, as the faces of blocks of leaves.
    static bool areCutAlike(const Scene& scene, const Face& face, const Face& other);
    // Whether both are of bodies of which one's priority says which of them is there.
    static bool isRanked(const Scene& scene, const Face& face, const Face& other);
    static std::int32_t priorityOf(const Scene& scene, const Face& face);
    // Whether light that meets one of them does not meet the other, and should.
    static bool hidesOther(const Scene& scene, const Face& face, const Face& other);
    static void search(const Scene& scene, const Face& face, std::uint32_t points, Found& found);
    static void addNotices(const Found& found, std::vector<Notice>& notices);
    // Of glass: the side of a body that the ray enters by, where that is among what it meets there
    // together with the side that it leaves by; else as chosen so far.
    RayHit nearSide(const Ray& ray, std::span<const RayHit> met, const RayHit& soFar) const;
    // The least is met.
    Order orderFor(const Ray& ray, const Face& face) const;

    const Scene& m_scene;
    std::vector<std::vector<bool>> m_isAmong;  // of each shape's triangles; empty of those without
};

}  // namespace pm
