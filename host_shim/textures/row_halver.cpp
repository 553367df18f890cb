// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/textures/row_halver.h"

#include <algorithm>
#include <cstdint>

namespace pm::host {
namespace {

template <int Channels>
void narrowByTwo(const float* row, int outWidth, float* out) {
    for (int x = 0; x < outWidth; ++x, row += 2 * Channels, out += Channels)
        for (int c = 0; c < Channels; ++c) out[c] = 0.5f * (row[c] + row[c + Channels]);
}

}  // namespace

RowHalver::RowHalver(int width, int height, int channels, Sink sink)
    : m_width(width),
      m_height(height),
      m_channels(channels),
      m_outWidth(std::max(1, width / 2)),
      m_outHeight(std::max(1, height / 2)),
      m_sink(std::move(sink)),
      m_columns(sharesOf(width, m_outWidth)),
      m_rows(sharesOf(height, m_outHeight)) {
    const std::size_t size =
        static_cast<std::size_t>(m_outWidth) * static_cast<std::size_t>(channels);
    m_narrow.resize(size);
    m_sum.resize(size);
    m_nextSum.resize(size);
}

std::vector<RowHalver::Share> RowHalver::sharesOf(int from, int to) {
    std::vector<Share> shares(static_cast<std::size_t>(from));
    // In units of 1 / to of a source texel all borders are whole numbers.
    const std::int64_t n = to, step = from;
    for (int i = 0; i < from; ++i) {
        const std::int64_t begin = i * n, end = begin + n;
        const std::int64_t target = begin / step, border = (target + 1) * step;
        const auto weight = [&](std::int64_t length) {
            return static_cast<float>(static_cast<double>(length) / static_cast<double>(step));
        };
        shares[static_cast<std::size_t>(i)] = {static_cast<int>(target),
                                               weight(std::min(end, border) - begin),
                                               weight(std::max<std::int64_t>(0, end - border))};
    }
    return shares;
}

void RowHalver::narrow(const float* row) {
    if (m_width == 2 * m_outWidth && m_channels == 3)
        return narrowByTwo<3>(row, m_outWidth, m_narrow.data());
    if (m_width == 2 * m_outWidth && m_channels == 1)
        return narrowByTwo<1>(row, m_outWidth, m_narrow.data());
    const auto channels = static_cast<std::size_t>(m_channels);
    std::ranges::fill(m_narrow, 0.0f);
    for (std::size_t x = 0; x < m_columns.size(); ++x) {
        const Share& share = m_columns[x];
        float* out = &m_narrow[static_cast<std::size_t>(share.target) * channels];
        for (std::size_t c = 0; c < channels; ++c) out[c] += share.first * row[x * channels + c];
        if (share.second <= 0.0f) continue;
        for (std::size_t c = 0; c < channels; ++c)
            out[channels + c] += share.second * row[x * channels + c];
    }
}

void RowHalver::add(const float* row) {
    narrow(row);
    const Share& share = m_rows[static_cast<std::size_t>(m_row++)];
    for (std::size_t i = 0; i < m_sum.size(); ++i) m_sum[i] += share.first * m_narrow[i];
    if (share.second > 0.0f)
        for (std::size_t i = 0; i < m_sum.size(); ++i) m_nextSum[i] += share.second * m_narrow[i];
    const bool isDone =
        m_row == m_height || m_rows[static_cast<std::size_t>(m_row)].target != share.target;
    if (!isDone) return;
    m_sink(m_sum.data());
    m_sum.swap(m_nextSum);
    std::ranges::fill(m_nextSum, 0.0f);
}

}  // namespace pm::host
