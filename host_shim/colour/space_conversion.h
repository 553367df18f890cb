// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "host_shim/colour/transfer_curve.h"

namespace pm::host {

// Converts pixels from one colour space to another. A cheap value (shared, immutable inside); apply
// may be called from several threads on different pixels.
class SpaceConversion {
  public:
    struct Processor;  // hides OpenColorIO

    // Leaves everything as it is.
    SpaceConversion();
    explicit SpaceConversion(std::shared_ptr<const Processor> processor);

    // The same of codes, which the curve makes the light that this one converts.
    SpaceConversion ofCodes(const TransferCurve& curve) const;

    bool isIdentity() const;
    // Identifies the conversion: equal strings convert equally. "identity" for the identity.
    std::string cacheId() const;
    // In place. Pixel i is at values[i * channelsPerPixel]; its first three channels are converted,
    // further ones kept. channelsPerPixel >= 3; values.size() is a multiple of it.
    void apply(std::span<float> values, int channelsPerPixel) const;

  private:
    void applyCurve(std::span<float> values, std::size_t channels) const;

    std::optional<TransferCurve> m_curve;  // comes first
    std::shared_ptr<const Processor> m_processor;
};

}  // namespace pm::host
