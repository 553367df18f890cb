// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What the writers of EXR files share.
#pragma once

#include <OpenImageIO/imageio.h>

#include <cstdint>

#include "host_shim/pictures/picture.h"

namespace pm::host {

// Windows, channels and attributes of a picture as an EXR file has them: scanline, ZIP. The
// channels' values are not looked at.
OIIO::ImageSpec exrSpec(const Picture& picture, bool halfColour);

// A value as half holds it: finite ones beyond +-65504 become that, and are counted.
float clampedToHalf(float value, std::int64_t& clamped);

}  // namespace pm::host
