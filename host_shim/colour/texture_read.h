// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace pm::host {

// A picture file's texels as floats, interleaved, rows from the top; integers as fractions of full
// code. Colour is straight (not multiplied by alpha).
struct TextureImage {
    std::int32_t width{}, height{};
    std::int32_t channels{};        // at most 4
    std::int32_t alphaChannel{-1};  // -1: none
    bool isFloatFile{};
    bool is8Bit{};
    std::vector<float> values;
};

// Reads the first part and level. keepAlphaAside: treat an alpha channel as such and undo its
// multiplication; else all channels are taken as they are stored (data).
// Errors: HostError kFile when missing, kBadInput when broken, cut short or no picture.
TextureImage readTexture(const std::filesystem::path& file, bool keepAlphaAside);

}  // namespace pm::host
