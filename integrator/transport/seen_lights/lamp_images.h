// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/materials/bsdf.h"
#include "integrator/scene/camera.h"
#include "integrator/scene/scene.h"
#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

// Lobes that a path to a lamp that is seen may follow.
inline constexpr std::array<Lobe, 3> kDeltaLobes{Lobe::kReflection, Lobe::kRefraction,
                                                 Lobe::kStraight};

// A rectangle of the frame, pixels.
struct FrameArea {
    double x0, y0, x1, y1;

    bool isNear(double x, double y, double distance) const {
        return x > x0 - distance && x < x1 + distance && y > y0 - distance && y < y1 + distance;
    }
};

// A lamp's image, straight or by way of delta lobes, that is no larger than a pixel: a rectangle of
// the frame around it, pixels. It says where to look, not what is there.
struct LampImage {
    std::array<double, 2> centre, along, across;  // the rectangle's middle and its half axes

    // u: in [0, 1]^2.
    std::array<double, 2> at(Vec2f u) const;
    bool holds(double x, double y) const;
    double area() const;
    // Half the size of the upright rectangle around it.
    std::array<double, 2> halfSize() const;
    // Whether that rectangle and the area have a part in common.
    bool isAround(const FrameArea& frame) const;
};

// Of the area lights of a scene, those that touch as one; none where there are more than 2048, as
// looking for the images takes time with each.
std::vector<LightBall> lampBalls(const Scene& scene);

// One of the rays of a camera path that follows every delta lobe.
struct LampRay {
    std::uint64_t lobes;  // that led to it: base 4, after a leading 1
    double x, y;          // where the path left the camera, pixels
    Ray ray;
};
// The lamps' radiance along the path through a place of the frame that follows every delta lobe, as
// far as they carry something. Adds its rays to `rays`.
Rgb followLobes(const Scene& scene, const LightSampler& lights, const Camera& camera, double x,
                double y, std::vector<LampRay>& rays);

// Images that reach into an area of the frame, among paths of that area. How far a lamp's ball is
// from the line of a ray is nearly linear in the ray's place, for rays by way of the same lobes: a
// fit of it tells where it would be 0, and Newton's method goes there; so it does from the ray that
// passes the ball most closely. Of many lamps only those are tried that lie where the rays lead. It
// may miss images.
// Threads: from any.
std::vector<LampImage> findLampImages(const Scene& scene, const Camera& camera,
                                      const std::vector<LightBall>& lamps, const FrameArea& area,
                                      std::vector<LampRay> rays);

}  // namespace pm
