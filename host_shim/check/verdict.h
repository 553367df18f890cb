// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host_shim/check/reference.h"
#include "host_shim/pictures/display_compare.h"
#include "host_shim/pictures/picture.h"

namespace pm::host {

// One thing that is not as it was: by which measure, and where and how much.
struct Finding {
    std::string measure;  // "size", "colour metadata", "region", "bits", ...
    std::string text;
};

struct Verdict {
    std::vector<Finding> findings;
    bool isSameBuild{};  // by build, instruction set and hashes: then bits are compared
    bool isSameBuildOfAnotherScene{};  // by all of these but the scene's
    bool hasSameBits{};
    bool isPaired{};                    // it shares the reference's noise
    std::optional<double> correlation;  // of their noise, where bits differ
    // Where bits may differ: the furthest region, as a share of its limit, and the change of one
    // region that would be found (median of the regions), by pairs of 8 pixels, else of 16.
    double shareOfLimit{}, seenChange{};
};

// A new render against the stored one. Not finite values, size, data window, channels and colour
// metadata come first; what is wrong there ends the comparison. Then bits where both come from the
// same build, instruction set, scene and settings; else regions and pixels by their standard
// errors.
// Where the noise of both is known to be shared, regions by what twins differ by as well. noise:
// what other seeds make of the pixels, or null.
Verdict comparePictures(const Picture& stored, const Picture& picture, const Reference& reference,
                        const Picture* noise = nullptr);

// Regions of display pictures: those whose mean code is off by more than codeLimit beyond chance.
// view: before what is told.
void compareCodes(const DisplayPicture& picture, const PixelRect& window, const DisplayNoise& noise,
                  double codeLimit, const std::string& view, Verdict& verdict);

// The means of a display picture's regions in codes of 255.
std::vector<double> codeMeans(const DisplayPicture& picture, const PixelRect& window,
                              std::int32_t side);

// The pixel that is off by most of the standard errors that both pictures tell (channels stderr.X,
// Y, Z; taken as no smaller than the mean around); 0 where either has none.
struct PixelFinding {
    std::int32_t x{}, y{};
    int channel{};
    double z{};
    float wanted{}, got{};
};
PixelFinding furthestPixel(const Picture& stored, const Picture& picture);

}  // namespace pm::host
