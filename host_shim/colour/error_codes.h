// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>
#include <vector>

#include "host_shim/colour/display_transform.h"
#include "host_shim/pictures/error_words.h"

namespace pm::host {

// What display and view show of a picture's error. Noise: the half differences are one draw of it,
// with all that pixels and channels have in common; the codes change by it as by the error. Bias
// and what was cut off, of which a render knows the mean only, are added as if each pixel had them.
class ErrorCodes {
  public:
    // transform must outlive this. biasRelMse: relMSE of bias and of what was cut off, at least 0;
    // offset: that of relMSE's denominator, above 0.
    ErrorCodes(const DisplayTransform& transform, double biasRelMse, double offset);

    // R, G and B of some pixels, and of each the layer halfdiff; as many of each.
    void add(std::span<const float> values, std::span<const float> halfDifferences);

    // Of all pixels that were added; 0 of none.
    SeenError result() const;

  private:
    const DisplayTransform& m_transform;
    double m_bias, m_offset;
    std::vector<float> m_dark, m_bright;  // codes that a pixel may be off by, twice a pixel
};

}  // namespace pm::host
