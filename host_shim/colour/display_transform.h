// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "host_shim/colour/space_conversion.h"

namespace pm::host {

// What was wrong with the pixels given to a display transform.
struct DisplayCleaning {
    std::int64_t nanCount{};       // values that were NaN, replaced by 0
    std::int64_t infiniteCount{};  // values that were infinite, replaced by +-kLargestDisplayInput
};

// Values beyond are clamped before the view: the ACES output transforms turn 1e30 into black and
// one infinity into three NaN. The largest half, far above what any view tells from white.
inline constexpr float kLargestDisplayInput = 65504.0f;

// Rendering space -> display and view (and look), as fractions of full code.
class DisplayTransform {
  public:
    explicit DisplayTransform(SpaceConversion conversion) : m_conversion(std::move(conversion)) {}

    // In place, layout as in SpaceConversion::apply. Exposes, cleans, applies the view, clamps to
    // [0,1]. Threads: may be called at once on different pixels.
    DisplayCleaning apply(std::span<float> values, int channelsPerPixel) const;

    // What values are multiplied by first, as a power of two.
    void setExposureStops(double stops) { m_gain = static_cast<float>(std::exp2(stops)); }

  private:
    SpaceConversion m_conversion;
    float m_gain{1.0f};
};

}  // namespace pm::host
