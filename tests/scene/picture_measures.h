// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "host_shim/pictures/picture.h"

namespace pm::host::test {

using Means = std::array<double, 3>;

// Fails, naming channel and pixel, on an empty picture and on the first NaN or infinity in any
// channel. To be asked before anything is compared: a comparison with NaN is never "too far".
testing::AssertionResult allFinite(const Picture& picture);

// Fails where no pixel has light or, with a fraction, where less of the pixels that show something
// (A above 0) have.
testing::AssertionResult isLit(const Picture& picture, double fraction = 0.0);

// Means over the data window of PREFIXR, PREFIXG, PREFIXB, such as prefix "caustic.".
Means meansOf(const Picture& picture, const std::string& prefix = "");

// A picture of a half of the width and height, each pixel the mean of 2 x 2: what a box filter of
// one pixel gives there. Both sides must be even.
Picture halved(const Picture& picture);

// Of one picture held against a reference with the same windows.
struct ReferenceError {
    double relMse{};     // as design has it, over the pixels that are kept
    double predicted{};  // the same from the picture's own standard errors: noise, no bias
    // Mean of R + G + B over the reference's, over the pixels with nothing above 5 in the reference
    // within two pixels: lamps and their mirror images are loud and say nothing of lost light.
    double meanRatio{};
};
// dropped: fraction of the pixels, those of the largest error, that relMse and predicted leave out.
ReferenceError errorAgainst(const Picture& reference, const Picture& picture, double dropped = 0.0);

}  // namespace pm::host::test
