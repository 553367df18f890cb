// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "scheduler/film/frame_error.h"
#include "scheduler/film/frame_store.h"

namespace pm::test {

inline constexpr std::int32_t kSize = 64;
inline constexpr Rect kFrame{0, 0, kSize, kSize};
inline constexpr std::size_t kPixels = kSize * kSize;
inline constexpr std::int32_t kChannels = 6;  // beauty, probe

using Random = std::mt19937;

// A picture of kFrame.
struct Rendered {
    FrameError estimate;
    double relMse = 0;  // against the truth
};

inline double relMseOf(const FrameStore& frame, const std::vector<float>& truth) {
    std::vector<float> picture(3 * kPixels);
    frame.read(kFrame, 0, 3, picture.data(), 12, 12 * kSize);
    double sum = 0;
    for (std::size_t i = 0; i < picture.size(); ++i) {
        const double r = static_cast<double>(truth[i / 3]);
        const double off = static_cast<double>(picture[i]) - r;
        sum += off * off / (r * r + 0.01);
    }
    return sum / static_cast<double>(picture.size());
}

}  // namespace pm::test
