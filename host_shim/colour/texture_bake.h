// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/colour/colour_pipeline.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

namespace pm::host {

enum class TextureKind {
    kColour,  // converted to the rendering space: Kd, Ks, Ke, Tf, environment
    kData,    // never converted: d, Ns, Pr, Pm, Ps, bump, norm, disp
};

struct TextureRequest {
    std::filesystem::path file{};
    TextureKind kind{TextureKind::kColour};
    std::string colorspace{};  // -colorspace of the map line; empty when it has none
    bool clamp{};              // -clamp on: the edge is repeated, else the whole texture is
};

struct BakedTexture {
    std::filesystem::path file;  // the .tx
    std::int32_t width{}, height{};
    std::int32_t channels{};   // colour: 3, or 4 with alpha; data: as the file, at most 4
    TextureSpace space;        // what the file was taken to be in
    std::int64_t badTexels{};  // values that were NaN or infinite, replaced by 0
};

// Makes tiled, mip-mapped .tx files in the rendering space, converted before any filtering, in half
// (8-bit colour) or float, so that nothing is clipped. Colour is straight (not multiplied by alpha)
// and grey becomes three channels. The container is OpenEXR.
class TextureBaker {
  public:
    // folder must exist and outlive the use of the textures; the caller removes it. colour must
    // outlive the baker. goOn: called again and again while a texture is made; what it throws ends
    // bake() at once, though a thread may go on for a while in vain (see callAsking); may be empty.
    TextureBaker(const ColourPipeline& colour, std::filesystem::path folder,
                 std::function<void()> goOn = {});

    // Bakes once for each file, space, kind and clamp; asked again, it answers from memory. The
    // name is the file's stem and a hash of these and of the conversion.
    // Errors: kFile when the file is missing or the .tx can't be written; kBadInput when it is
    // broken, not a picture, or its colour space is unknown. The text names the file.
    // Threads: one at a time.
    const BakedTexture& bake(const TextureRequest& request);

  private:
    const ColourPipeline& m_colour;
    std::filesystem::path m_folder;
    std::function<void()> m_goOn;
    std::map<std::string, BakedTexture> m_baked;
};

}  // namespace pm::host
