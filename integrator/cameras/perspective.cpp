// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/cameras/perspective.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "integrator/values/error.h"

namespace pm {

Perspective::Perspective(const CameraDescription& camera, double halfHeight)
    : m_aspect(camera.pixelAspect > 0 ? camera.pixelAspect : 1.0) {
    if (!(camera.verticalFieldOfView > 0 && camera.verticalFieldOfView < std::numbers::pi))
        throw Error(Status::kInvalidScene,
                    fmt::format("the camera's vertical field of view is {} radians; it must be "
                                "above 0 and below pi",
                                camera.verticalFieldOfView));
    // sin/cos of the half angle by the double-precision library would differ between processors in
    // the last bit of a double only; rounding the scale to float removes even that.
    m_scale = static_cast<double>(static_cast<float>(std::tan(0.5 * camera.verticalFieldOfView))) /
              halfHeight;
}

}  // namespace pm
