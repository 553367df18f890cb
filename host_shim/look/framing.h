// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <optional>
#include <span>

#include "host_shim/formats/scene_data.h"

namespace pm::host {

// What the command line says about the camera; what it leaves out is found from the bounds.
struct CameraOptions {
    std::optional<std::array<double, 3>> eye, lookAt, up;
    std::optional<double> verticalFovDegrees;  // in (0,180)
    bool fromNegativeZ{};  // where the default eye stands; see opensTowardsNegativeZ
};

struct CameraPose {
    std::array<double, 3> eye{};
    std::array<double, 3> lookAt{};
    std::array<double, 3> up{0, 1, 0};
    double verticalFov{};                // radians
    double verticalFovDegrees{};         // what it was made of
    std::array<double, 12> transform{};  // camera to world, 3 x 4 row-major; looks along -z, +y up
    bool upWasReplaced{};                // up was parallel to the view
    CameraLens lens;
};

// A point light where the camera stands, for scenes without one: irradiance 2 on what faces the
// camera at the middle of the scene. A white wall there reflects a radiance of 2/pi, and light from
// wall to wall adds to that.
LightData cameraLight(const CameraPose& camera, const Bounds& bounds);

// Whether more of the scene's fronts are seen from the -z side than from +z, as of a room without
// its wall there: the sum of area times normal, which is 0 for closed shapes, then points to -z by
// more than 1/20 of all area.
bool opensTowardsNegativeZ(const SceneData& scene);

// A perspective camera. By default it stands on the +z side (or -z, as the options say) of the
// bounds and looks along -z at their centre, fov 40 degrees, just far enough that the front face of
// the bounds fits with a margin of 5 %: for a box that is open to the front, the usual picture.
// What is flat in y or x, as a ground alone, is seen from 45 degrees above or beside it.
// aspect is width / height, > 0. Errors: kUsage when eye and look-at are the same point.
CameraPose frameCamera(const CameraOptions& options, const Bounds& bounds, double aspect);

// The camera that a scene describes, or what of it the options leave. Errors: as frameCamera.
CameraPose poseOf(const CameraData& camera, const CameraOptions& options, const Bounds& bounds,
                  double aspect);

// Where a described camera stands.
std::optional<std::array<double, 3>> placeOf(const CameraData& camera);

// Where a camera that looks at the bounds' middle from this direction (not along y; any length) has
// all of their corners in the picture, with the same margin.
std::array<double, 3> eyeFrom(const std::array<double, 3>& direction, const Bounds& bounds,
                              double verticalFov, double aspect);

// Where a camera stands and what it looks at.
struct ViewPoint {
    std::array<double, 3> eye{}, lookAt{};
};

// The view along a direction (from what is seen to the eye; not along y; any length) that has all
// of these points just in the picture, with the same margin. points: not empty.
ViewPoint viewOf(std::span<const std::array<double, 3>> points,
                 const std::array<double, 3>& direction, double verticalFov, double aspect);

}  // namespace pm::host
