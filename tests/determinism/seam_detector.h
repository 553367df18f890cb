// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Seams between buckets, found in the picture alone: gradients across the borders of buckets
// against gradients elsewhere. It needs no second picture, so it would also find what all sizes
// share.
#pragma once

#include <vector>

namespace pm::test {

// A picture of one number a pixel, row by row, all above 0.
struct GreyPicture {
    int width = 0, height = 0;
    std::vector<float> values;

    double at(int x, int y) const {
        return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
};

// By how much the mean gradient across borders of buckets, which lie at multiples of bucketSize,
// exceeds that across lines elsewhere, relative to the pixels' values.
//
// A gradient is the step of the logarithm from one pixel to the next, less the mean of the steps
// before and behind it (what is smooth is no seam), averaged along 8 pixels (seams are at least as
// long, noise is not), without its sign. Those with an outline in them, a step above 0.1, are left
// out, so a larger seam is not seen. bucketSize: 8 or more; the picture is larger than one bucket
// and has 8 pixels without an outline along a border and elsewhere.
double seamExcess(const GreyPicture& picture, int bucketSize);

// Student's t of the mean of independent numbers: how many of its own standard errors it is off 0.
double studentT(const std::vector<double>& numbers);

}  // namespace pm::test
