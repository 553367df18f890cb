// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/sampling/pixel_filter.h"
#include "integrator/values/vec.h"

namespace pm {

// Where a ray leaves the camera, pixels of the frame.
struct Place {
    double x, y;
};

// What is sampled as one pixel: a pixel, or a group of twice its side.
struct PixelCell {
    std::int32_t x, y;  // its left and upper edge, pixels
    bool isGroup;

    // Its own among all pixels.
    std::uint64_t key() const {
        return static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32 |
               static_cast<std::uint32_t>(x);
    }
    // The even passes' samples are one low-discrepancy sequence, the odd passes' another: samples
    // added later fall between those before, and the two halves' errors share nothing. Groups have
    // sequences that no pixel has. Odd streams are photons'; see PhotonTracer. Streams from 8 on
    // are those of SeenLamps.
    std::uint64_t stream(std::uint32_t pass) const {
        return 2 * std::uint64_t{pass % 2} + (isGroup ? 4 : 0);
    }
    // u: in [0, 1)^2; distributed as the filter weighs.
    Place place(PixelFilter filter, Vec2f u) const {
        const double side = isGroup ? 2.0 : 1.0;
        return {x + side * placeInPixel(filter, u.x), y + side * placeInPixel(filter, u.y)};
    }
};

}  // namespace pm
