// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/determinism/seam_detector.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pm::test {

namespace {

constexpr double kOutline = 0.1;
constexpr int kLength = 8;  // pixels

// Sums of gradients and how many there are.
struct Mean {
    double sum = 0.0;
    int count = 0;

    void add(double value) {
        sum += value;
        ++count;
    }
    double value() const { return sum / count; }
};

// value(along, across): the logarithm of a pixel, in the picture or in its transpose.
template <typename Value>
void addGradients(int acrossSize, int alongSize, int bucketSize, Value&& value, Mean& borders,
                  Mean& elsewhere) {
    for (int begin = 0; begin + kLength <= alongSize; begin += kLength) {
        for (int at = 2; at + 1 < acrossSize; ++at) {
            double sum = 0.0, largest = 0.0;
            for (int i = begin; i < begin + kLength; ++i) {
                const double step = 1.5 * (value(i, at) - value(i, at - 1)) -
                                    0.5 * (value(i, at + 1) - value(i, at - 2));
                largest = std::max(largest, std::abs(step));
                sum += step;
            }
            if (largest > kOutline) continue;
            const int phase = at % bucketSize;
            // Lines beside a border have half of its step in theirs.
            if (phase == 0)
                borders.add(std::abs(sum / kLength));
            else if (phase != 1 && phase != bucketSize - 1)
                elsewhere.add(std::abs(sum / kLength));
        }
    }
}

}  // namespace

double seamExcess(const GreyPicture& picture, int bucketSize) {
    GreyPicture logs = picture;
    for (float& value : logs.values) value = std::log(value);
    Mean borders, elsewhere;
    addGradients(
        picture.width, picture.height, bucketSize, [&](int y, int x) { return logs.at(x, y); },
        borders, elsewhere);
    addGradients(
        picture.height, picture.width, bucketSize, [&](int x, int y) { return logs.at(x, y); },
        borders, elsewhere);
    return borders.value() - elsewhere.value();
}

double studentT(const std::vector<double>& numbers) {
    const auto count = static_cast<double>(numbers.size());
    double mean = 0.0, squares = 0.0;
    for (const double number : numbers) mean += number / count;
    for (const double number : numbers) squares += (number - mean) * (number - mean);
    return mean / std::sqrt(squares / (count - 1) / count);
}

}  // namespace pm::test
