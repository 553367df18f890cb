// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <variant>

#include "integrator/cameras/perspective.h"

namespace pm {

// How a kind of camera sees, each in a file of its own. A new kind: its parameters and name in
// camera_description.h, and two lines here.
using CameraModel = std::variant<Perspective>;

inline CameraModel makeCameraModel(const CameraDescription& camera, double halfHeight) {
    switch (camera.kind) {
        case CameraKind::kPerspective:
            break;
    }
    return Perspective(camera, halfHeight);
}

}  // namespace pm
