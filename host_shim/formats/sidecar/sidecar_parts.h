// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What the parts of a sidecar share.
#pragma once

#include <optional>

#include "host_shim/formats/scene_data.h"
#include "host_shim/formats/sidecar/json_place.h"

namespace pm::host {

inline constexpr const char* kSidecarSchema = "pm-sidecar/1";

// matrix, or translate, rotate and scale: first scaled, then turned about x, y and z, then moved.
// None where there are none of these keys.
std::optional<Transform> readPlacement(const JsonPlace& at);

// Rotation about x, then y, then z. Quarter turns are exact.
Transform rotationOf(const std::array<double, 3>& degrees);

// A transform that looks along -z from a place, +y towards up. back: the opposite of where it
// looks, not 0. Where up is along it another direction is taken.
Transform lookingAlong(const std::array<double, 3>& back, const std::array<double, 3>& up,
                       const std::array<double, 3>& eye);

// matrix of a rotation and a translation. Errors: as JsonPlace, for one that stretches.
Transform readRotation(const JsonPlace& at);

LightData readLight(const JsonPlace& at);
CameraData readCamera(const JsonPlace& at);

}  // namespace pm::host
