// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "host_shim/pictures/picture.h"

namespace pm::host::test {

struct GoldenBounds {
    double sigmas{5.0};
    // What a photon map may be off besides noise, as a fraction of the golden region's mean.
    double bias{};
    // Attributes that say how the golden picture was made.
    std::set<std::string> freeAttributes{};
};

// Holds runs with different seeds against a golden picture with stderr.X/.Y/.Z: region by region of
// 8 x 8 pixels, and over the whole, the mean of R, G and B is off by at most
//     bias * golden + sigmas * sqrt(golden's variance + runs' variance).
// The runs' variance of a region comes from their spread, since what photons bring is shared by
// neighbours. NaN and infinity fail first; then the first run must have the golden's frame, data
// window, channels and attributes, and may have more attributes. The failure names the worst
// region; success tells its sigmas.
testing::AssertionResult agreesWithGolden(const Picture& golden, const std::vector<Picture>& runs,
                                          const GoldenBounds& bounds);

}  // namespace pm::host::test
