// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/values/vec.h"

namespace pm {

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
