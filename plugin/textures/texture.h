// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <memory>

#include "plugin/textures/texture_system.h"

namespace pm::plugin {

// A picture with the cache that it is read through.
struct Texture {
    std::shared_ptr<TextureSystem> system;
    TexturePicture picture;
};

}  // namespace pm::plugin
