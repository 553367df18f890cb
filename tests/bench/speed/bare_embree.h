// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "integrator/rays/ray_tracer.h"
#include "integrator/scene/scene.h"

namespace pm::bench {

// Embree with nothing around it: the triangles of a scene as one mesh, its spheres as Embree's own
// sphere points. What our rays are held against. Threads: const functions from any, at once.
class BareEmbree {
  public:
    // robust: RTC_SCENE_FLAG_ROBUST or Embree's fast mode.
    BareEmbree(const Scene& scene, bool robust);
    ~BareEmbree();
    BareEmbree(const BareEmbree&) = delete;
    BareEmbree& operator=(const BareEmbree&) = delete;

    // How many of the rays hit; one ray at a time.
    std::uint64_t countHits(std::span<const Ray> rays) const;
    std::uint64_t countOccluded(std::span<const Ray> rays) const;
    // The same, eight neighbours in the list at a time, told to be coherent; what is left over at
    // the end is left out.
    std::uint64_t countHitsByEight(std::span<const Ray> rays) const;
    std::uint64_t countOccludedByEight(std::span<const Ray> rays) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

// The same shapes in a RayTracer of its own, which the Scene does not give away.
class LoneRayTracer {
  public:
    explicit LoneRayTracer(const Scene& scene);

    const RayTracer& tracer() const { return m_tracer; }

  private:
    std::vector<std::vector<Vec3f>> m_positions;
    RayTracer m_tracer;  // last: it refers to the positions
};

}  // namespace pm::bench
