// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/cameras/camera_description.h"
#include "integrator/cameras/camera_ray.h"

namespace pm {

// A pinhole camera.
class Perspective {
  public:
    // halfHeight: of the frame, pixels. Throws Error(kInvalidScene) for a field of view outside
    // (0, pi).
    Perspective(const CameraDescription& camera, double halfHeight);

    CameraRay ray(const CameraSample& sample) const {
        return {{0.0, 0.0, 0.0}, {sample.x * m_scale * m_aspect, sample.y * m_scale, 1.0}};
    }
    PixelWidth pixelWidth() const { return {0.0, m_scale}; }

  private:
    double m_scale;   // of a pixel on the plane at distance 1
    double m_aspect;  // width of a pixel over its height
};

}  // namespace pm
