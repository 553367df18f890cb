// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <OpenColorIO/OpenColorIO.h>

namespace pm::host {

// Names in the built-in config.
inline constexpr const char* kLinearRec709 = "lin_rec709_scene";
inline constexpr const char* kSrgbTexture = "srgb_rec709_scene";

// The config that pm brings: linear Rec.709 as scene_linear, no LUT files. Made anew by each call.
OCIO_NAMESPACE::ConstConfigRcPtr makeBuiltInConfig();

}  // namespace pm::host
