// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <optional>

#include "integrator/scene/scene.h"

namespace pm {

// How near other surfaces are to a place, by short rays.
// Threads: const functions from any, at once.
class Surroundings {
  public:
    // scene must outlive this. normal: unit, geometric, on the side that is looked at. offset:
    // along it, to where rays leave from; least: the smallest distance told, both in scene units.
    Surroundings(const Scene& scene, const Vec3f& position, const Vec3f& normal, float offset,
                 float least)
        : m_scene(scene),
          m_position(position),
          m_normal(normal),
          m_offset(offset),
          m_least(least) {}

    // To what is met in a direction (unit), scene units; nothing beyond `farthest`.
    std::optional<float> distanceAlong(const Vec3f& direction, float farthest) const;

    // The smallest distance that a few rays meet, scene units; infinity beyond `farthest`. Straight
    // up alone would not do: in a corner what is near is beside the place. pattern: chooses them.
    float clearance(float farthest, std::uint32_t pattern) const;

  private:
    const Scene& m_scene;
    Vec3f m_position, m_normal;
    float m_offset, m_least;
};

}  // namespace pm
