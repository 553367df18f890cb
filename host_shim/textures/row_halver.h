// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <functional>
#include <vector>

namespace pm::host {

// Rows of a picture in, rows of its next mip level out: max(1, size / 2) on each side, each texel
// the mean over the area that it covers. Sums have one order. For one thread.
class RowHalver {
  public:
    using Sink = std::function<void(const float* row)>;
    RowHalver(int width, int height, int channels, Sink sink);

    // The next row; sink is called for each row that is then complete.
    void add(const float* row);

  private:
    // What a source texel gives to one of the two that it may reach into.
    struct Share {
        int target{};
        float first{}, second{};  // weights of target and of target + 1
    };
    static std::vector<Share> sharesOf(int from, int to);
    void narrow(const float* row);

    int m_width, m_height, m_channels, m_outWidth, m_outHeight;
    Sink m_sink;
    std::vector<Share> m_columns, m_rows;
    int m_row{};
    std::vector<float> m_narrow, m_sum, m_nextSum;
};

}  // namespace pm::host
