// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/cameras/camera_description.h"
#include "integrator/cameras/camera_ray.h"

namespace pm {

// A camera whose rays are parallel.
class Orthographic {
  public:
    // halfHeight: of the frame, pixels.
    Orthographic(const CameraDescription& camera, double halfHeight)
        : m_scale(0.5 * camera.height / halfHeight),
          m_aspect(camera.pixelAspect > 0 ? camera.pixelAspect : 1.0) {}

    CameraRay ray(const CameraSample& sample) const {
        return {{sample.x * m_scale * m_aspect, sample.y * m_scale, 0.0}, {0.0, 0.0, 1.0}};
    }
    PixelWidth pixelWidth() const { return {m_scale, 0.0}; }

  private:
    double m_scale, m_aspect;
};

}  // namespace pm
