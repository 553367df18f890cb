// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>
#include <vector>

namespace pm::bench {

// A picture's values, RGB, row by row.
using Values = std::vector<double>;

// Pixels that are far noisier than those beside them: what one sees as specks.
struct Specks {
    double worstRatio = 0;  // of a pixel's standard deviation to the median of its neighbours'
    int x = 0, y = 0;       // where that is
    int count = 0;          // pixels whose ratio is above kSpeckRatio
    double judged = 0;      // share of the pixels that have enough neighbours to be judged by
};
inline constexpr double kSpeckRatio = 20;

// pictures: of one scene by two seeds or more. A pixel is judged by those of the 9 x 9 pixels
// around it whose mean over the seeds is within a factor 2 of its own, if there are 8 or more;
// values are means over the channels. Where nothing varies the ratio is 1.
Specks findSpecks(std::span<const Values> pictures, int width, int height);

// Of two pictures of one scene that share no noise: of each pixel the mean over its channels of
// (a - b)^2 / (2 (m^2 + 0.01)), m = (a + b) / 2.
struct PairError {
    double mean = 0;     // over the pixels: about the relMSE of either for its noise
    double ofWorst = 0;  // share of the sum that the worst .1 % of the pixels hold
};
PairError errorOfPair(const Values& a, const Values& b);

}  // namespace pm::bench
