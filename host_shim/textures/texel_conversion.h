// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "host_shim/colour/space_conversion.h"

namespace pm::host {

// A SpaceConversion made fast for codes of 8 or 16 bits. Nearly all of those are a curve for each
// channel and a matrix, so that what the three codes of a texel come to is a sum of three table
// entries; whether that holds is tried, and where it doesn't the conversion itself is applied.
// Immutable once made, so any thread may use it.
class TexelConversion {
  public:
    // codes: how many codes a channel has (256 or 65536), 0 for floats. channels: 3, or 1 for grey.
    TexelConversion(SpaceConversion conversion, int codes, int channels);

    // Channels of what comes out: 1 for grey that stays grey, else 3.
    int outChannels() const { return m_outChannels; }
    // The largest value that can come out, where the codes' tables say so; else infinity.
    float largest() const { return m_largest; }
    // texels * channels codes -> texels * outChannels() values.
    void apply(std::span<const std::uint8_t> codes, std::span<float> values) const;
    void apply(std::span<const std::uint16_t> codes, std::span<float> values) const;
    // The same of floats, in place where outChannels() is channels.
    void apply(const std::vector<float>& from, std::vector<float>& values) const;

  private:
    using Entry = std::array<float, 4>;  // the fourth is padding

    void decideGrey();
    void makeTables();
    bool tablesHold() const;
    std::array<float, 3> converted(float r, float g, float b) const;
    template <typename Code>
    void applyCodes(std::span<const Code> codes, std::span<float> values) const;

    SpaceConversion m_conversion;
    int m_codes{}, m_channels{}, m_outChannels{};
    float m_largest{};
    std::vector<float> m_grey;                    // by code; empty where tables don't hold
    std::array<std::vector<Entry>, 3> m_entries;  // the same of colours
};

}  // namespace pm::host
