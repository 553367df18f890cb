// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/buckets/static_orders.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "scheduler/buckets/bucket_order.h"

namespace pm {
namespace {

// SplitMix64 (Steele, Lea & Flood 2014): a standard library's shuffle differs from one to the next.
class SplitMix64 {
  public:
    explicit SplitMix64(std::uint64_t seed) : m_state(seed) {}

    std::uint64_t next() {
        std::uint64_t z = m_state += 0x9e3779b97f4a7c15ull;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return z ^ (z >> 31);
    }

    // Range: [0, bound). What would make the first numbers likelier is drawn again.
    std::uint64_t below(std::uint64_t bound) {
        const std::uint64_t surplus = (0 - bound) % bound;  // 2^64 mod bound
        for (;;) {
            if (const std::uint64_t bits = next(); bits >= surplus) return bits % bound;
        }
    }

  private:
    std::uint64_t m_state;
};

}  // namespace

std::vector<std::uint32_t> rowOrder(std::int32_t columns, std::int32_t rows) {
    std::vector<std::uint32_t> order(checkedCellCount(columns, rows));
    std::iota(order.begin(), order.end(), 0u);
    return order;
}

std::vector<std::uint32_t> columnOrder(std::int32_t columns, std::int32_t rows) {
    const std::uint32_t cells = checkedCellCount(columns, rows);
    const auto width = static_cast<std::uint32_t>(columns);
    std::vector<std::uint32_t> order;
    order.reserve(cells);
    for (std::uint32_t column = 0; column < width && cells > 0; ++column) {
        for (std::uint64_t cell = column; cell < cells; cell += width) {
            order.push_back(static_cast<std::uint32_t>(cell));
        }
    }
    return order;
}

std::vector<std::uint32_t> diagonalOrder(std::int32_t columns, std::int32_t rows) {
    const std::uint32_t cells = checkedCellCount(columns, rows);
    std::vector<std::uint32_t> order;
    if (cells == 0) return order;
    order.reserve(cells);
    const std::int64_t w = columns, h = rows;
    for (std::int64_t sum = 0; sum <= w + h - 2; ++sum) {
        const std::int64_t last = std::min(sum, h - 1);
        for (std::int64_t y = std::max<std::int64_t>(0, sum - w + 1); y <= last; ++y) {
            order.push_back(static_cast<std::uint32_t>(y * w + sum - y));
        }
    }
    return order;
}

// Ring r around the centre is walked up on its right, left along its top, down on its left and
// right along its bottom, and ends beside the start of the next. Where an even side has more cells
// on one side of the centre, they are to the right and above: the two runs that come first.
std::vector<std::uint32_t> spiralOrder(std::int32_t columns, std::int32_t rows) {
    const std::uint32_t cells = checkedCellCount(columns, rows);
    std::vector<std::uint32_t> order;
    if (cells == 0) return order;
    order.reserve(cells);
    constexpr std::int64_t kZero = 0;
    const bool isTall = rows > columns;  // then with x and y exchanged
    const std::int64_t w = std::max(columns, rows), h = std::min(columns, rows);
    const std::int64_t cx = (w - 1) / 2, cy = h / 2;
    const auto visit = [&](std::int64_t x, std::int64_t y) {
        order.push_back(static_cast<std::uint32_t>(isTall ? x * columns + y : y * columns + x));
    };
    visit(cx, cy);
    for (std::int64_t r = 1; order.size() < cells; ++r) {
        const std::int64_t left = cx - r, right = cx + r, top = cy - r, bottom = cy + r;
        for (auto y = std::min(bottom - 1, h - 1); right < w && y >= std::max(top, kZero); --y)
            visit(right, y);
        for (auto x = std::min(right - 1, w - 1); top >= 0 && x >= std::max(left, kZero); --x)
            visit(x, top);
        for (auto y = std::max(top + 1, kZero); left >= 0 && y <= std::min(bottom, h - 1); ++y)
            visit(left, y);
        for (auto x = std::max(left + 1, kZero); bottom < h && x <= std::min(right, w - 1); ++x)
            visit(x, bottom);
    }
    return order;
}

// Fisher and Yates's shuffle.
std::vector<std::uint32_t> randomOrder(std::int32_t columns, std::int32_t rows,
                                       std::uint64_t seed) {
    std::vector<std::uint32_t> order = rowOrder(columns, rows);
    SplitMix64 generator(seed);
    for (std::size_t left = order.size(); left > 1; --left) {
        std::swap(order[left - 1], order[generator.below(left)]);
    }
    return order;
}

}  // namespace pm
