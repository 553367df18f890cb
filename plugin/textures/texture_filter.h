// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Look-ups in a picture's levels. Places are in units of the picture, origin upper left; sides of a
// footprint likewise, finite. tiles: of the calling thread.
#pragma once

#include "integrator/values/vec.h"
#include "plugin/textures/held_tiles.h"
#include "plugin/textures/texture_picture.h"

namespace pm::plugin {

// Bilinear within a level, linear between levels, by several probes along a footprint's longer
// axis. Returns false when texels can't be read.
bool filtered(const TexturePicture& picture, HeldTiles& tiles, Vec2f place, Vec2f sideX,
              Vec2f sideY, TexelValues& value);

// The four texels of the finest level between which a place lies, and the weights of the right and
// of the lower ones.
struct TexelQuad {
    std::array<TexelValues, 4> texels;  // upper left, upper right, lower left, lower right
    float right = 0.0f, lower = 0.0f;
};
bool texelsAround(const TexturePicture& picture, HeldTiles& tiles, Vec2f place, TexelQuad& quad);

}  // namespace pm::plugin
