// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/textures/texel_conversion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pm::host {
namespace {

constexpr float kRounding = 2e-6f;  // relative, of sums in another order
constexpr int kTries = 512;

bool areClose(float a, float b, float scale) {
    return std::fabs(a - b) <= kRounding * std::max(1e-3f, scale);
}

float scaleOf(const std::array<float, 3>& colour) {
    return std::max({std::fabs(colour[0]), std::fabs(colour[1]), std::fabs(colour[2])});
}

}  // namespace

TexelConversion::TexelConversion(SpaceConversion conversion, int codes, int channels)
    : m_conversion(std::move(conversion)),
      m_codes(codes),
      m_channels(channels),
      m_largest(std::numeric_limits<float>::infinity()) {
    decideGrey();
    if (m_codes > 0) makeTables();
}

std::array<float, 3> TexelConversion::converted(float r, float g, float b) const {
    std::array<float, 3> colour{r, g, b};
    m_conversion.apply(colour, 3);
    return colour;
}

void TexelConversion::decideGrey() {
    m_outChannels = 3;
    if (m_channels == 3) return;
    for (const float v : {0.0f, 0.01f, 0.18f, 0.5f, 1.0f, 10.0f, 1000.0f}) {
        const auto colour = converted(v, v, v);
        const float scale = 10 * scaleOf(colour);  // chromaticities have five digits
        if (!areClose(colour[0], colour[1], scale) || !areClose(colour[2], colour[1], scale))
            return;
    }
    m_outChannels = 1;
}

void TexelConversion::makeTables() {
    const auto count = static_cast<std::size_t>(m_codes);
    const float full = static_cast<float>(m_codes - 1);
    if (m_outChannels == 1) {
        m_grey.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            const float code = static_cast<float>(i) / full;
            m_grey[i] = m_conversion.isIdentity() ? code : converted(code, code, code)[1];
        }
        m_largest = *std::ranges::max_element(m_grey);
        return;
    }
    const auto black = converted(0, 0, 0);
    for (std::size_t c = 0; c < 3; ++c) {
        m_entries[c].resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            std::array<float, 3> code{};
            code[c] = static_cast<float>(i) / full;
            const auto colour = converted(code[0], code[1], code[2]);
            // Black is in all three and counts once.
            for (std::size_t k = 0; k < 3; ++k)
                m_entries[c][i][k] = c == 0 ? colour[k] : colour[k] - black[k];
        }
    }
    if (!tablesHold()) {
        m_entries = {};
        return;
    }
    float sum = 0.0f;
    for (const auto& entries : m_entries) {
        float most = 0.0f;
        for (const Entry& entry : entries) most = std::max({most, entry[0], entry[1], entry[2]});
        sum += most;
    }
    m_largest = sum;
}

bool TexelConversion::tablesHold() const {
    std::uint32_t state = 1;
    const auto random = [&] {
        state = state * 1664525u + 1013904223u;
        return static_cast<std::size_t>((state >> 8) % static_cast<std::uint32_t>(m_codes));
    };
    const float full = static_cast<float>(m_codes - 1);
    for (int i = 0; i < kTries; ++i) {
        const std::size_t r = random(), g = random(), b = random();
        const auto right = converted(static_cast<float>(r) / full, static_cast<float>(g) / full,
                                     static_cast<float>(b) / full);
        for (std::size_t k = 0; k < 3; ++k) {
            const float sum = m_entries[0][r][k] + m_entries[1][g][k] + m_entries[2][b][k];
            if (!std::isfinite(sum) || !areClose(sum, right[k], scaleOf(right))) return false;
        }
    }
    return true;
}

template <typename Code>
void TexelConversion::applyCodes(std::span<const Code> codes, std::span<float> values) const {
    if (!m_grey.empty()) {
        for (std::size_t i = 0; i < codes.size(); ++i) values[i] = m_grey[codes[i]];
        return;
    }
    if (!m_entries[0].empty() && m_channels == 3) {
        const Entry *red = m_entries[0].data(), *green = m_entries[1].data(),
                    *blue = m_entries[2].data();
        for (std::size_t i = 0; i + 3 <= codes.size(); i += 3) {
            const Entry &r = red[codes[i]], &g = green[codes[i + 1]], &b = blue[codes[i + 2]];
            for (std::size_t k = 0; k < 3; ++k) values[i + k] = r[k] + g[k] + b[k];
        }
        return;
    }
    const float full = static_cast<float>(m_codes - 1);
    const auto repeats = static_cast<std::size_t>(3 / m_channels);
    for (std::size_t i = 0; i < codes.size(); ++i)
        std::fill_n(&values[i * repeats], repeats, static_cast<float>(codes[i]) / full);
    m_conversion.apply(values, 3);
}

void TexelConversion::apply(std::span<const std::uint8_t> codes, std::span<float> values) const {
    applyCodes(codes, values);
}

void TexelConversion::apply(std::span<const std::uint16_t> codes, std::span<float> values) const {
    applyCodes(codes, values);
}

void TexelConversion::apply(const std::vector<float>& from, std::vector<float>& values) const {
    if (m_channels == 1) {
        std::vector<float> colours(from.size() * 3);
        for (std::size_t i = 0; i < from.size(); ++i) std::fill_n(&colours[3 * i], 3, from[i]);
        m_conversion.apply(colours, 3);
        values.resize(from.size() * static_cast<std::size_t>(m_outChannels));
        if (m_outChannels == 3)
            values = std::move(colours);
        else
            for (std::size_t i = 0; i < from.size(); ++i) values[i] = colours[3 * i + 1];
        return;
    }
    values = from;
    m_conversion.apply(values, 3);
}

}  // namespace pm::host
