// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "integrator/light_sampling/place_cells.h"
#include "integrator/lights/environment.h"
#include "integrator/sampling/sphere_cells.h"
#include "integrator/values/vec.h"

namespace pm {

// In which directions the environment is seen from where: learnt from rays of places where light
// will be asked for. In a room only a window's directions bring light. Places that are near each
// other share a table over cells of the sphere; within a cell directions are uniform. A share of
// the directions is the environment's own choice, so that what the few rays did not see, and what
// is bright within a cell, is found all the same.
// Threads: const functions from any, at once.
class SkyGuide {
  public:
    using Directions = SphereCells<16>;

    // Light that one of the places receives from along a direction: sum of the channels of its
    // radiance times the cosine, >= 0; 0 where something is before it.
    using Look = std::function<float(std::size_t place, const Vec3f& direction)>;

    // environment: must outlive this. At least one place; only their positions count. look: called
    // from any thread, a pure function. Works in parallel in the calling TBB arena; the result is
    // the same bits for any number of threads.
    SkyGuide(const Environment& environment, std::span<const Receiver> places, std::uint64_t seed,
             const Look& look);

    // A unit direction to look along for light at a position, and its density, sr^-1, which is > 0.
    Vec3f sample(const Vec3f& position, Vec2f u, float& pdfSolidAngle) const;
    float pdfSolidAngle(const Vec3f& position, const Vec3f& direction) const;

    std::uint64_t memoryBytes() const {
        return m_places.memoryBytes() + m_tables.size() * sizeof(float);
    }

  private:
    class Learner;

    // Cumulative probabilities of the cells of directions, the last is 1. Null far from all that
    // was learnt: there the environment chooses alone.
    const float* table(const Vec3f& position) const;
    float pdfBy(const float* cumulative, const Vec3f& direction) const;

    const Environment& m_environment;
    float m_ownShare;  // of the environment's own choice
    PlaceCells m_places;
    std::vector<float> m_tables;  // one leaf after another
};

}  // namespace pm
