// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace pm::host {

// What a texture is used for.
enum class TextureKind {
    kColour,  // converted to the rendering space: Kd, Ks, Ke, Tf, environment
    kData,    // a number, never converted: Ns, Pr, Pm, Ps, bump, disp
    kMask,    // the same of d: the alpha of a picture that has one
    kVector,  // three numbers, never converted: normal maps
};

// Texels that were replaced by 0.
struct BadTexelCount {
    std::int64_t negative{};   // a colour channel below 0
    std::int64_t notFinite{};  // infinite or NaN
};

// A prepared texture: what is known of it without opening it.
struct TextureFacts {
    std::int32_t width{}, height{};
    std::int32_t channels{};                   // 1 or 3
    std::array<std::uint64_t, 2> texelHash{};  // as the library makes it of the file, never 0, 0
    BadTexelCount bad;                         // texels that were replaced by 0
    std::string note;                          // what was chosen of the picture; may be empty
    bool isLikeNormals{};  // colours, of which a number was made, of a normal map
    bool hasHoles{};       // colours, of a picture whose alpha has some seen through
    bool isCutOut{};       // and some not
};

}  // namespace pm::host
