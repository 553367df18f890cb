// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "integrator/scene/scene.h"
#include "integrator/values/rect.h"

namespace pm::test {

// A path tracer that shares as little with the renderer as it can: it asks a scene what a ray meets
// and a closure to sample a direction, adds what shines where it arrives, and nothing else. It has
// random numbers of its own, finds which bodies a place is inside of by counting faces, and takes
// what they absorb by exp(-sigma d). No lamp is sampled, so lamps have to be large or the sky
// bright; none may be a point. Source: Kajiya 1986.
class BruteForce {
  public:
    // width, height: of the frame, pixels. scene: must outlive this.
    BruteForce(const Scene& scene, std::int32_t width, std::int32_t height);

    // Mean radiance over a rectangle of the frame, by `samples` paths. seed: of all of them.
    std::array<double, 3> mean(const Rect& area, std::uint32_t samples, std::uint64_t seed) const;

  private:
    // The faces of all bodies of one material, scene's own coordinates.
    struct Body {
        std::uint32_t material;
        std::vector<std::array<Vec3d, 3>> faces;
        std::vector<std::pair<Vec3d, double>> balls;
        double volume = 0;  // of its box

        bool holds(const Vec3d& place) const;
    };
    class Path;

    // -1: of vacuum.
    std::int32_t mediumAt(const Vec3d& place) const;

    const Scene& m_scene;
    std::int32_t m_width, m_height;
    std::vector<Body> m_bodies;
};

}  // namespace pm::test
