// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/values/vec.h"

namespace pm {

// What a ray of a camera is chosen by. A kind that has no lens or shutter asks for no more than the
// place.
struct CameraSample {
    // On the frame, pixels; what is given to a kind is right of and above its middle.
    double x = 0.0, y = 0.0;
    Vec2f lens{0.5f, 0.5f};  // in [0, 1)^2
    float time = 0.0f;       // within the shutter, in [0, 1]
};

// A ray in a camera's own space: x right, y up, z forward, from where it stands; scene units. The
// direction has any length.
struct CameraRay {
    Vec3d origin, direction;
};

// How wide a pixel is where a ray through it begins, scene units, and by how much it widens for
// each unit of the way on.
struct PixelWidth {
    double width = 0.0, spread = 0.0;
};

}  // namespace pm
