// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "integrator/photons/map/photon_map.h"
#include "integrator/sampling/warps.h"
#include "integrator/values/vec.h"

namespace pm {

// Where the light comes from that gather rays look for. Where most of it leaves a small part of the
// scene (walls beside a lamp in a corner), rays by the cosine meet that part seldom, and the mean
// of a few is noisy. Some photons, drawn in proportion to their flux, stand for all of them: each
// sends light by the cosine to any place, whatever lies between. Half of the rays follow that, half
// the cosine alone, so a wrong guess costs at most twice the rays.
// Sources of the ideas: Jensen 1995, "Importance Driven Path Tracing using the Photon Map"; Keller
// 1997, "Instant Radiosity", for photons that stand for lamps.
// Threads: const functions from any, at once.
class GatherGuide {
  public:
    // photons: in the order of a map, so that the drawn ones are spread over space. radius: of
    // their estimates, scene units; nearer than that no photon counts for more.
    GatherGuide(const PhotonMap& photons, float radius);

    // How a place's rays are spread: the square of sampleCosineHemisphere's random numbers in
    // cells, each with a share.
    class Directions {
      public:
        struct Warped {
            Vec2f u;        // in [0, 1) both
            float density;  // of such numbers over that of even ones, >= 1/2
        };
        // A monotonous map of the square onto itself: well-spread numbers stay so.
        Warped warp(Vec2f u) const;

      private:
        friend class GatherGuide;
        // By the second number, the turn about the normal, and within by the first, the squared
        // sine.
        static constexpr std::size_t kTurns = 16, kSines = 16;
        std::array<float, kTurns + 1> m_turns{};  // cumulative, from 0 to 1
        std::array<std::array<float, kSines + 1>, kTurns> m_sines{};
    };
    // frame: of the shading normal there, as the rays'.
    Directions at(const Vec3f& position, const Frame& frame) const;

    // By the directions of a guide, or by the cosine alone where there are none.
    static Directions::Warped warp(const std::optional<Directions>& directions, Vec2f u) {
        return directions ? directions->warp(u) : Directions::Warped{u, 1.0f};
    }

  private:
    struct Emitter {
        Vec3f position, normal;
    };
    std::vector<Emitter> m_emitters;
    float m_nearestSquared;
};

}  // namespace pm
