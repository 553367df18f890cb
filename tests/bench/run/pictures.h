// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <vector>

namespace pm::bench {

struct Picture {
    int width = 0, height = 0;
    std::vector<double> rgb;  // linear Rec.709, row by row
};

// The first three channels of a picture file. Throws Error(kIo).
Picture readPicture(const std::filesystem::path& file);

// 8 bits, sRGB, clipped, each value times `exposure` first. Throws Error(kIo).
void writePng(const std::filesystem::path& file, const Picture& picture, double exposure);

// 32-bit float, linear. Throws Error(kIo).
void writeExr(const std::filesystem::path& file, const Picture& picture);

// Where a picture is wrong: mid grey is right, brighter is too bright, darker too dark; each
// channel is (x - r) / sqrt(r^2 + 0.01) averaged over a square of 2 * blur + 1 pixels, times
// `scale`, plus 1/2.
Picture differencePicture(const Picture& picture, const Picture& reference, int blur, double scale);

}  // namespace pm::bench
