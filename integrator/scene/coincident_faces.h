// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <compare>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "integrator/scene/scene.h"

namespace pm {

// Lamps that lie in their ceiling's plane, glass that stands exactly on a floor: rays meet both
// within roundings, and which one is told would be chance. Here it is a rule: a lamp that shines
// towards the ray before what is opaque, that before what is half transparent, and that before
// glass, so that light that has come through glass is on the floor and not beyond it; of two alike
// the first in the scene.
//
// Opaque faces that lie on opaque ones are not looked for.
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

    std::uint64_t memoryBytes() const;

  private:
    struct Face {
        std::uint32_t shape, primitive;
        auto operator<=>(const Face&) const = default;
    };
    struct Found;
    enum class Rank : std::uint8_t { kGlass, kSheet, kOpaque, kShining };

    CoincidentFaces(const Scene& scene, const std::vector<Face>& faces);
    static Rank rankOf(const Scene& scene, const Face& face);
    static bool isOn(const Scene& scene, const Face& face, const Surface& point);
    static void search(const Scene& scene, const Face& face, std::uint32_t points, Found& found);
    static void addNotices(const Found& found, std::vector<Notice>& notices);
    // The least is met.
    std::pair<int, Face> orderFor(const Ray& ray, const Face& face) const;

    const Scene& m_scene;
    std::vector<std::vector<bool>> m_isAmong;  // of each shape's triangles; empty of those without
};

}  // namespace pm
