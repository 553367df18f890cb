// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <OpenImageIO/imageio.h>

#include <array>
#include <string>
#include <vector>

#include "host_shim/textures/texture_facts.h"

namespace pm::host {

// Which of a picture's channels are taken, and how.
struct PictureLayout {
    enum class Values {
        kColour,     // red, green, blue
        kGrey,       // one channel for all three
        kTwo,        // red and green; blue is 0
        kXyz,        // CIE XYZ, white at luminance 1
        kLuminance,  // a number made of red, green, blue
        kNumber,     // one channel
    };
    int part{};  // of a file that has several
    Values values{Values::kColour};
    std::vector<int> channels;  // of that part, in the order of `values`
    int alpha{-1};              // what colours were multiplied by and are divided by; -1: none
    std::string note;           // what a user should know of the choice; empty: nothing
};

// Chooses by the names of the channels, not their order: red, green, blue (or luminance) without a
// layer's name first; else those of the layer that is called combined, beauty, rgba or the like;
// else of the first layer that has all three. `parts`: the specs of all parts of the file. channel:
// of -imfchan, r g b m l z, or 0.
// Errors: HostError kBadInput where nothing fits; the text has no file's name.
PictureLayout choosePictureLayout(const std::vector<OIIO::ImageSpec>& parts, TextureKind kind,
                                  char channel);

}  // namespace pm::host
