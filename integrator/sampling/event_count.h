// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

namespace pm {

// How often a path or photon has been scattered. Russian roulette ends those that lose something on
// their way, however little. What loses nothing, as light between perfect mirrors or caught in a
// block of glass, could go on for ever: after 256, 1024 and 4096 such events in a row half of it
// goes on, and counts for all. What is still there after 16384 ends, and is told of: photons by
// flux, paths by number and throughput.
class EventCount {
  public:
    // A hundred times as many as a path has, in the mean, where all reflects 0.9999.
    static constexpr int kMost = 1'000'000;
    // In a row, each of which keeps all but a rounding.
    static constexpr int kMostLossless = 16384;

    // Of one that goes on with that probability. Returns that by which roulette has to go.
    float add(float survival) {
        m_lossless = survival < kLossless ? 0 : m_lossless + 1;
        ++m_events;
        return m_lossless == 256 || m_lossless == 1024 || m_lossless == 4096 ? 0.5f * survival
                                                                             : survival;
    }
    int count() const { return m_events; }
    bool isOver() const { return m_events >= kMost || m_lossless >= kMostLossless; }

  private:
    static constexpr float kLossless = 1.0f - 1e-6f;

    int m_events = 0, m_lossless = 0;
};

}  // namespace pm
