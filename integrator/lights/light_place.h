// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/values/vec.h"

namespace pm {

// Where a light shines from; it decides what it is asked, see light_kinds.h.
enum class LightPlace : std::uint8_t {
    kOnSurface,  // a primitive of a shape, which rays meet
    kAtPoint,    // no area: no ray meets it
    kFar         // infinitely far: met by rays that meet nothing else
};

// What a light that is described beside the shapes has to know of the scene.
struct SceneBox {
    Vec3d centre;    // world; the origin of the scene's own coordinates
    Vec3d halfSize;  // of the box around it that holds all shapes, along the axes
};

// What a light adds to the bounds of groups of lights; scene's own coordinates.
struct LightExtent {
    Vec3d lo, hi;               // of its box
    Vec3f axis;                 // unit: it shines to that side of the plane across it
    bool anyDirection = false;  // or to all sides; then there is no axis
};

// Directions within an angle of a unit axis whose cosine is 1 - oneMinusCos.
struct DirectionCone {
    Vec3f axis{0.0f, 0.0f, 1.0f};
    float oneMinusCos = 2.0f;
};

// A ball around a light that has an area, or around several side by side.
struct LightBall {
    Vec3f centre;  // scene's own coordinates
    float radius;
};

}  // namespace pm
