// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "host_shim/pictures/picture.h"
#include "tests/colour/scratch.h"

namespace pm::host::test {

// How far a value may be from the golden one:
// absolute + relative * |golden| + sigmas * sqrt(golden's variance + picture's variance).
struct PictureTolerance {
    double absolute{};
    double relative{};
    double sigmas{};
    // Standard errors of the golden's and of the picture's mean, by the same channel names over the
    // same data window; used with sigmas, either may be missing.
    const Picture* goldenErrors{};
    const Picture* pictureErrors{};
    // Attributes that may differ, such as pm:version.
    std::set<std::string> freeAttributes{};
};

// Clears OCIO*, OPENIMAGEIO* and LC_* from the environment, then fails on any NaN or infinity in
// either picture before it compares anything (a comparison with NaN is never "too far"), then on
// a differing frame, data window, set of channels or attribute, then on values too far apart. The
// failure names the worst pixel.
testing::AssertionResult samePicture(const Picture& golden, const Picture& picture,
                                     const PictureTolerance& tolerance = {});

// Reads both as EXR files.
testing::AssertionResult sameExr(const std::string& golden, const std::string& picture,
                                 const PictureTolerance& tolerance = {});

}  // namespace pm::host::test
