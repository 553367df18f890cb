// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/transport/frame/render_settings.h"

namespace pm {

// Where each layer stands in a pixel's floats. A layer that is not wanted has offset -1.
struct ChannelLayout {
    std::int32_t beauty = 0;     // 3: radiance, the sum of the four parts below
    std::int32_t alpha = 3;      // 1: coverage
    std::int32_t direct = 4;     // 3
    std::int32_t indirect = 7;   // 3
    std::int32_t caustic = 10;   // 3
    std::int32_t emission = 13;  // 3
    std::int32_t albedo = -1;    // 3: premultiplied by coverage
    std::int32_t normal = -1;    // 3: world, premultiplied by coverage
    std::int32_t depth = -1;     // 1: along the view axis, scene units, premultiplied by coverage
    // 3: beauty with the radii of all estimates narrowed by sqrt(2), minus beauty; what shows bias
    std::int32_t biasProbe = -1;
    // 6, the last: of the samples that adaptive renders decide by (SampleRun::seen) the number, the
    // sums of the beauty's channels, the sum over samples and channels of their squares, and 1
    // where they met unlike surfaces first, 0 where all met the same.
    std::int32_t seen = -1;
    // 1, after those and where groups may be divided (RenderSettings::hasGroups): what a group's
    // sample shows, a whole number below 2^25 that is another for another object or material.
    std::int32_t contribution = -1;
    std::int32_t count = 16;  // floats a pixel
};

ChannelLayout channelLayout(const RenderSettings& settings);

}  // namespace pm
