// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "host_shim/formats/pov/values/transform_of.h"
#include "host_shim/formats/scene_data.h"

namespace pm::host::pov {

// POV-Ray's space is left-handed: x right, y up, z away. This one mirror takes it to ours, in which
// z comes near; it is applied to what the scene ends with, once.
std::array<double, 3> mirrored(const std::array<double, 3>& point);
// A transform of POV-Ray's space, as ours has it: mirror, transform, mirror.
Transform mirroredTransform(const Matrix& transform);

// A camera as POV-Ray has it: rays go from the location along direction + x right + y up, x and y
// from -1/2 to 1/2.
struct PovCamera {
    std::array<double, 3> location{0, 0, 0}, direction{0, 0, 1}, right{4.0 / 3, 0, 0}, up{0, 1, 0};

    double aspect() const;  // of the picture: width over height
};

// By the camera statement's items: location, direction, right, up and sky as they are, the angle
// (which is horizontal) next, look_at after it, and transforms last, in their order.
PovCamera povCameraOf(const Node& camera);

// For a picture of so many pixels; none where the three vectors lie in a plane.
std::optional<CameraData> cameraOf(const PovCamera& camera,
                                   const std::array<std::int32_t, 2>& size);

}  // namespace pm::host::pov
