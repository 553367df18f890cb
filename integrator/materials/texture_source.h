// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "integrator/values/cancel_check.h"
#include "integrator/values/uv_footprint.h"
#include "integrator/values/vec.h"

namespace pm {

inline constexpr std::int32_t kNoTexture = -1;

// Four channels of a texture at a point; missing colour channels repeat the first, missing alpha
// is 1.
struct Texel {
    float r{}, g{}, b{}, a{1.0f};
};

// A texel as light: channels that are infinite or NaN count as 0, and so do those below 0 where the
// rest adds up to no more than 0. Elsewhere single channels may be below 0: so are saturated
// colours of a wider space than the rendering space.
inline Texel asLight(Texel texel) {
    for (float* const channel : {&texel.r, &texel.g, &texel.b, &texel.a})
        if (!(std::abs(*channel) <= std::numeric_limits<float>::max())) *channel = 0.0f;
    if (texel.r + texel.g + texel.b > 0.0f) return texel;
    return {std::fmax(texel.r, 0.0f), std::fmax(texel.g, 0.0f), std::fmax(texel.b, 0.0f), texel.a};
}

// Texels of which no light can be: adding up to less than 0, or with a channel that is infinite or
// NaN.
struct BadTexels {
    std::uint64_t negative = 0, notFinite = 0;

    bool any() const { return negative + notFinite > 0; }
};

// A channel of a normal map as a component in [-1, 1]. largestCode: 1 of floats, of which 0.5 is 0;
// else that of the file's integers, of which the code above the middle is exactly 0: 128 of 255,
// 32768 of 65535.
inline float decodedNormal(float channel, float largestCode) {
    const float zero = largestCode > 1.0f ? 0.5f * (largestCode + 1.0f) : 0.5f;
    return std::clamp((channel * largestCode - zero) / (largestCode - zero), -1.0f, 1.0f);
}

// Where on a surface a texture is asked for.
struct TextureContext {
    Vec2f uv;
    Vec3f place{};  // in the scene's own coordinates; 0 where only uv is known, as on lamps
    UvFootprint footprint{};  // over which it is filtered

    // The same at the finest level.
    TextureContext finest() const { return {uv, place, {}}; }
};

// Where texture look-ups come from; the host side of the plugin implements it, so that the
// integrator knows no picture files. Texels are in the rendering space, or data.
class TextureSource {
  public:
    virtual ~TextureSource() = default;

    // The value of texture `index` there, filtered over the footprint. Threads: any, at once; the
    // value depends on the arguments only. Errors: a failed look-up returns 0 and counts; it never
    // throws.
    virtual Texel lookUp(std::int32_t index, const TextureContext& at) const = 0;

    // The same of a normal map, as its components in [-1, 1]. A source that knows nothing of files
    // says what floats mean.
    virtual Vec3f normalAt(std::int32_t index, const TextureContext& at) const {
        const Texel texel = lookUp(index, at);
        return {decodedNormal(texel.r, 1.0f), decodedNormal(texel.g, 1.0f),
                decodedNormal(texel.b, 1.0f)};
    }

    // The finest level at uv, of a light: every texel as asLight() has it before anything is
    // interpolated. Threads and errors as above.
    virtual Texel lookUpOfLight(std::int32_t index, Vec2f uv) const {
        return asLight(lookUp(index, {uv}));
    }

    // Whether texture `index` is known to be black all over a box of uv: by levels that were made
    // beforehand, so that many texels take one look. A source that has none says no.
    virtual bool isBlackWithin(std::int32_t, Vec2f /*lo*/, Vec2f /*hi*/) const { return false; }

    // How many texels of the finest level such a light has. Throws Error(kCancelled) soon after
    // cancel is set.
    virtual BadTexels badTexels(std::int32_t, const CancelCheck&) const { return {}; }

    // The least and the largest first channel of all texels of the finest level, and of what lies
    // outside of the picture. A source that doesn't know says 0 and 1. Throws Error(kCancelled)
    // soon after cancel is set.
    virtual std::array<float, 2> extremes(std::int32_t, const CancelCheck&) const {
        return {0.0f, 1.0f};
    }

    // What a user knows texture `index` by.
    virtual std::string name(std::int32_t index) const { return std::to_string(index); }

    // Texels across and down of texture `index` over the unit square of uv, at the finest level.
    virtual std::array<std::uint32_t, 2> texels(std::int32_t index) const = 0;

    // Bytes that are always held, beside texels.
    virtual std::uint64_t memoryBytes() const { return 0; }

    // Failed look-ups so far.
    virtual std::uint64_t failureCount() const = 0;
};

}  // namespace pm
