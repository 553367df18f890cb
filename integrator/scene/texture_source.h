// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>

#include "integrator/values/vec.h"

namespace pm {

inline constexpr std::int32_t kNoTexture = -1;

// Four channels of a texture at a point; missing colour channels repeat the first, missing alpha
// is 1.
struct Texel {
    float r{}, g{}, b{}, a{1.0f};
};

// Where texture look-ups come from; the host side of the plugin implements it, so that the
// integrator knows no picture files. Texels are in the rendering space, or data.
class TextureSource {
  public:
    virtual ~TextureSource() = default;

    // The value of texture `index` at uv, filtered over a square of side `width` in uv units (0 =
    // the finest level). Threads: any, at once; the value depends on the arguments only. Errors: a
    // failed look-up returns 0 and counts; it never throws.
    virtual Texel lookUp(std::int32_t index, Vec2f uv, float width) const = 0;

    // Texels across and down of texture `index` over the unit square of uv, at the finest level.
    virtual std::array<std::uint32_t, 2> texels(std::int32_t index) const = 0;

    // Failed look-ups so far.
    virtual std::uint64_t failureCount() const = 0;
};

}  // namespace pm
