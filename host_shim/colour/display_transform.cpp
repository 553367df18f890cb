// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/colour/display_transform.h"

#include <algorithm>
#include <cmath>

namespace pm::host {
namespace {

float cleaned(float value, DisplayCleaning& report) {
    if (std::isnan(value)) {
        ++report.nanCount;
        return 0.0f;
    }
    if (std::isinf(value)) ++report.infiniteCount;
    return std::clamp(value, -kLargestDisplayInput, kLargestDisplayInput);
}

}  // namespace

DisplayCleaning DisplayTransform::apply(std::span<float> values, int channelsPerPixel) const {
    DisplayCleaning report;
    const auto channels = static_cast<std::size_t>(channelsPerPixel);
    for (std::size_t i = 0; i + 2 < values.size(); i += channels) {
        for (std::size_t c = 0; c < 3; ++c)
            values[i + c] = std::clamp(m_gain * cleaned(values[i + c], report),
                                       -kLargestDisplayInput, kLargestDisplayInput);
    }
    m_conversion.apply(values, channelsPerPixel);
    for (std::size_t i = 0; i + 2 < values.size(); i += channels) {
        for (std::size_t c = 0; c < 3; ++c) {
            float& value = values[i + c];
            // The comparison is false for NaN, should a view make one of finite values.
            value = value > 0.0f ? std::min(value, 1.0f) : 0.0f;
        }
    }
    return report;
}

}  // namespace pm::host
