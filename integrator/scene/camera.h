// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/cameras/camera_model.h"
#include "integrator/shapes/ray_footprint.h"
#include "integrator/values/ray.h"
#include "integrator/values/vec.h"

namespace pm {

class Scene;

// How wide a pixel is where a ray through it begins, scene units, and by how much it widens for
// each unit of the way on.
struct PixelBeam {
    float width = 0.0f, spread = 0.0f;

    float widthAfter(float way) const { return width + spread * way; }
};

// The camera of a scene and frame. Where it is more than a few of the scene's radii away
// its rays start where they enter the sphere around the scene, computed in double: a camera a
// thousand radii away loses no digits of the scene to its distance.
class Camera {
  public:
    // Throws Error(kInvalidScene) without a camera in the scene, or one with a field of view
    // outside (0, pi) or a transform that is not finite.
    Camera(const Scene& scene, std::int32_t width, std::int32_t height);

    // A ray through frame coordinates (x, y), pixels, origin top left, y down. Unit direction.
    Ray ray(const CameraSample& sample) const;

    // What that ray stands for: its pixel. Not known where no texture asks for it.
    RayFootprint footprint(const CameraSample& sample, const Ray& ray) const;

    // Of a ray of this camera's.
    PixelBeam pixelBeam(const Ray& ray) const;

    // Distance along the view axis of a point in the scene's own coordinates, scene units.
    float depth(const Vec3f& position) const;

  private:
    // A place where the camera stands, and a unit direction; scene's own coordinates.
    struct Line {
        Vec3d from, along;
    };
    Line lineThrough(const CameraSample& sample) const;

    const Scene& m_scene;
    Vec3d m_eye;  // scene's own coordinates
    Vec3d m_right, m_up, m_forward;
    CameraModel m_model;
    PixelWidth m_pixel;
    double m_halfWidth, m_halfHeight;  // pixels
    double m_sceneRadius;
    bool m_isFar;  // from the scene
};

}  // namespace pm
