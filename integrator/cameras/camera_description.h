// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/values/transform.h"

namespace pm {

enum class CameraKind { kPerspective };

// A camera that looks along -z of its transform, +y up, +x right.
struct CameraDescription {
    CameraKind kind = CameraKind::kPerspective;
    Transform cameraToWorld = kIdentityTransform;
    double verticalFieldOfView = 0.7;  // of perspective; radians, in (0, pi)
    double pixelAspect = 1.0;          // width of a pixel over its height
};

}  // namespace pm
