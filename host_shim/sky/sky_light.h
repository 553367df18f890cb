// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/formats/scene_data.h"
#include "host_shim/pictures/picture.h"
#include "host_shim/process/temporary_folder.h"

namespace pm::host {

// So many kcd/m^2 are a radiance of 1: what is white in full sun is about that.
inline constexpr double kLuminanceOfOne = 20.0;

// The sky of a day as an environment has it, latitude-longitude in linear Rec.709, the ground below
// the horizon included. The sun's disc is not in it. width: pixels, twice the height.
Picture skyPicture(const SkyData& sky, std::int32_t width);
// The sun, as a light that is infinitely far.
LightData sunLight(const SkyData& sky);
// What a scene says of its sky becomes an environment, whose picture goes to the folder, and a
// light. isZUp: of the scene; its environment is turned likewise. Errors: kFile.
void makeSky(bool isZUp, TemporaryFolder& folder, SceneData& scene);
// The rotation that takes an environment, whose up is y, to a scene whose up is z.
Transform turnedToZUp();

}  // namespace pm::host
