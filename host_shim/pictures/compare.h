// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "host_shim/pictures/picture.h"
#include "host_shim/values/host_error.h"

namespace pm::host {

struct ErrorReport {
    // Values of R, G, B that are NaN or infinite; looked for before anything is compared.
    std::int64_t badInPicture{};
    std::int64_t badInReference{};
    // None when a bad value was met.
    std::optional<double> relMse;
};

// Errors: kBadInput where a reference is of another size than the picture that is to be compared.
void checkSameSize(std::int32_t referenceWidth, std::int32_t referenceHeight, std::int32_t width,
                   std::int32_t height);

// Throws HostError(kBadInput), naming both, unless the reference's display window is width x height
// and its data window holds `dataWindow`.
void checkWindows(const Picture& reference, std::int32_t width, std::int32_t height,
                  const PixelRect& dataWindow);

// The offset of relMSE's denominator where values are judged times 2^stops: 0.01 * 4^-stops.
double errorOffset(std::int32_t errorScaleStops);

// The scale that a picture says its error is of (pm:errorScale); nothing where it says none, or one
// that no render has.
std::optional<std::int32_t> errorScaleOf(const Picture& picture);

// " at an error scale of 13 stops", for lines that tell a relMSE; empty at 0.
std::string errorScaleText(std::int32_t errorScaleStops);

// relMSE = mean over the pixels of the picture's data window and the channels R, G, B of
// (x - r)^2 / (r^2 + offset), r the reference, in scene-linear values. A picture of a crop is held
// against the same pixels of the whole. offset: errorOffset().
// Errors: kBadInput when the display windows differ, the picture's data window is empty or leaves
// the reference's, or either lacks R, G or B; the text names both sizes or the channel.
ErrorReport compareRelMse(const Picture& reference, const Picture& picture,
                          double offset = errorOffset(0));

}  // namespace pm::host
