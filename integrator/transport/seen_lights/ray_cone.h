// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/values/ray.h"
#include "integrator/values/vec.h"

namespace pm {

// What holds rays: a cone that begins at a ball.
class RayCone {
  public:
    // rays: one or more.
    explicit RayCone(std::span<const Ray> rays) {
        Vec3d along(0);
        for (const Ray& r : rays) {
            m_from += Vec3d(r.origin) * (1.0 / static_cast<double>(rays.size()));
            along += Vec3d(r.direction);
        }
        m_axis = length(along) > 0 ? normalize(along) : Vec3d(rays[0].direction);
        for (const Ray& r : rays) {
            m_radius = std::max(m_radius, length(Vec3d(r.origin) - m_from));
            m_cosine = std::min(m_cosine, dot(m_axis, Vec3d(r.direction)));
        }
        // Images may lie beyond the outermost of a few dozen rays.
        m_cosine = 1 - kWider * (1 - m_cosine);
    }
    // How large a ball seems from there, its radius over its distance; 0 outside of the cone.
    double seen(const LightBall& ball) const {
        const Vec3d to = Vec3d(ball.centre) - m_from;
        const auto radius = static_cast<double>(ball.radius);
        const double distance = length(to), sine = (radius + m_radius) / distance;
        if (!(sine < 1) || m_cosine < kAllAround) return radius / std::max(radius, distance);
        // Of the cone's angle and the ball's together.
        const double sineOfCone = std::sqrt(std::max(0.0, 1 - m_cosine * m_cosine));
        const double cosine = m_cosine * std::sqrt(1 - sine * sine) - sineOfCone * sine;
        return dot(m_axis, to) >= cosine * distance ? radius / distance : 0.0;
    }

  private:
    static constexpr double kWider = 2.25;  // of the squared angle
    static constexpr double kAllAround = -0.5;

    Vec3d m_from{0}, m_axis;
    double m_radius = 0, m_cosine = 1;
};

}  // namespace pm
