// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "integrator/values/vec.h"

namespace pm::plugin {

struct TextureFile;

// What lies outside [0,1]; the numbers are those of PMR_WRAP_* in pm_plugin.h.
enum class Wrap : std::int32_t { kRepeat, kClamp, kMirror, kBlack };

// How a picture is looked up: value = base + gain * texel. All numbers finite.
struct TextureMapping {
    Wrap wrapS = Wrap::kRepeat, wrapT = Wrap::kRepeat;
    Vec2f uvScale{1.0f, 1.0f};
    Vec2f uvOffset{};
    float gain = 1.0f;
    float base = 0.0f;
    std::array<std::uint64_t, 2> texelHash{};  // that the host knows; 0, 0: none
};

// A texture as a host asks for it.
struct TextureDescription : TextureMapping {
    std::string fileName;
};

// A picture and how it is looked up; a plain value that many scenes may share.
struct TexturePicture : TextureMapping {
    std::string fileName;
    void* handle = nullptr;  // OIIO::TextureSystem::TextureHandle, whose header is dear to compile
    std::shared_ptr<const TextureFile> file;
    std::uint32_t width = 1, height = 1;  // texels of the finest level
    int channelCount = 1;                 // as the file has, at most 4 are used
    float largestCode = 1.0f;             // of the file's integers of 8 or 16 bits; else 1
};

}  // namespace pm::plugin
