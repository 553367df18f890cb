// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/colour/error_codes.h"

#include <algorithm>
#include <cmath>

namespace pm::host {
namespace {

// Of pixels that are within what is told: more than the 95 % that is said, for the half differences
// are one draw only.
constexpr double kShare = 0.97;
// Parts that have less of the pixels have no figure of their own.
constexpr double kLeastPart = 0.05;

double quantile(std::vector<float> values) {
    if (values.empty()) return 0;
    const auto at = static_cast<std::ptrdiff_t>(kShare * static_cast<double>(values.size() - 1));
    std::ranges::nth_element(values, values.begin() + at);
    return values[static_cast<std::size_t>(at)];
}

}  // namespace

ErrorCodes::ErrorCodes(const DisplayTransform& transform, double biasRelMse, double offset)
    : m_transform(transform), m_bias(std::sqrt(biasRelMse)), m_offset(offset) {}

void ErrorCodes::add(std::span<const float> values, std::span<const float> halfDifferences) {
    std::vector<float> shown(values.begin(), values.end()), up = shown, down = shown;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double value = values[i], noise = halfDifferences[i];
        const double bias = m_bias * std::sqrt(value * value + m_offset);
        const auto error = static_cast<float>(noise + std::copysign(bias, noise));
        up[i] += error;
        down[i] -= error;
    }
    for (std::vector<float>* pixels : {&shown, &up, &down}) m_transform.apply(*pixels, 3);
    for (std::size_t i = 0; i + 2 < shown.size(); i += 3) {
        float code = 0, above = 0, below = 0;
        for (std::size_t c = i; c < i + 3; ++c) {
            code = std::max(code, shown[c]);
            above = std::max(above, std::abs(up[c] - shown[c]));
            below = std::max(below, std::abs(down[c] - shown[c]));
        }
        std::vector<float>& part = 255.0f * code < kBrightCode ? m_dark : m_bright;
        part.insert(part.end(), {255.0f * above, 255.0f * below});
    }
}

SeenError ErrorCodes::result() const {
    std::vector<float> all = m_dark;
    all.insert(all.end(), m_bright.begin(), m_bright.end());
    SeenError error;
    error.codes = quantile(all);
    const auto ofPart = [&](const std::vector<float>& part) {
        const bool isSmall =
            static_cast<double>(part.size()) < kLeastPart * static_cast<double>(all.size());
        return isSmall ? error.codes : quantile(part);
    };
    error.darkCodes = ofPart(m_dark);
    error.brightCodes = ofPart(m_bright);
    return error;
}

}  // namespace pm::host
