// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "integrator/scene/scene.h"
#include "integrator/values/box.h"

namespace pm {

// Which medium is where, in scenes whose bodies of glass and water overlap, touch or stand in each
// other, or absorb with something inside them. A body is a closed shape of one material, or open
// ones that are closed together, with the walls of cavities in it; where several are, the one of
// the highest priority is there, of equal ones that with the smaller box, of these the later. What
// is there is found by a ray from the place to the end of the boxes that it lies in, so that it
// does not matter how a path came: cameras, lights and kept points need know nothing of it.
// Threads: const functions from any, at once.
//
// A face of a body with the same medium on both sides is none: rays go on. Between a body and one
// that stands in it, a gap of vacuum narrower than kGap of the inner one's box is none either. So
// water that reaches into its glass, that lies on it exactly and that keeps such a gap make one
// picture. Source of priorities: Schmidt & Budge, "Simple Nested Dielectrics in Ray Traced Images",
// Journal of Graphics Tools 7(2), 2002.
class Scene::Media {
  public:
    // Null where faces alone say all. Bodies that are open, or turned inside out, are told where
    // it matters and left to their faces. The ray tracer must be ready. Throws Error(kCancelled).
    static std::unique_ptr<const Media> find(const Scene& scene, std::vector<Notice>& notices,
                                             const CancelCheck& cancel);

    static constexpr double kGap = 5e-4;  // of the diagonal

    // Whether a hit is on a body's face.
    bool isOfBody(const RayHit& hit) const { return bodyOf(hit) != nullptr; }
    // The material of what is at a place; kNoMedium of vacuum.
    std::int32_t at(const Vec3f& position) const;

    // Fills a surface's medium on the side that `direction` comes from and, of glass, its eta.
    // False: there is the same on both sides, and the face is none.
    bool resolve(const Vec3f& direction, Surface& surface) const;

    std::uint64_t memoryBytes() const;

  private:
    struct Body {
        std::uint32_t material;
        std::int32_t priority;
        Box3d box;
        // One closed convex shape: all behind a face of it is it.
        bool isConvex = false;
        // The box in float, wider by the gap and by what rounds.
        Vec3f lo{}, hi{};

        bool mayHold(const Vec3f& position) const {
            return position.x >= lo.x && position.y >= lo.y && position.z >= lo.z &&
                   position.x <= hi.x && position.y <= hi.y && position.z <= hi.z;
        }
        double size() const;
        float gap() const;  // scene units
        // Whether the other stands in it, to a gap.
        bool holds(const Body& other) const;
    };
    class Search;

    explicit Media(const Scene& scene) : m_scene(scene) {}
    const Body* bodyOf(const RayHit& hit) const;
    // Null of vacuum.
    const Body* bodyAt(const Vec3f& position) const;
    std::int32_t mediumOf(const Body* body) const;
    // The geometric normal where a ray meets a face.
    Vec3f frontAt(const RayHit& hit, const Ray& ray) const;
    // Whether no other body is near a place on a face of one that is convex.
    bool isAlone(const Body& body, const Vec3f& position) const;
    // What is beyond a face of a body, past a gap too: then the surface's offset is that.
    const Body* beyond(const Body& body, const Vec3f& towards, Surface& surface) const;
    bool isBefore(const Body& a, const Body& b) const;
    float ior(std::int32_t medium) const;

    const Scene& m_scene;
    std::vector<Body> m_bodies;
    std::vector<std::vector<std::uint32_t>> m_ofShape;  // bodies that its faces are of
};

}  // namespace pm
