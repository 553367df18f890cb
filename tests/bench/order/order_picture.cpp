// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/order/order_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "integrator/values/error.h"
#include "scheduler/buckets/bucket_order.h"

namespace pm::bench {

namespace {

constexpr int kCell = 16, kGap = 28, kPanelsPerRow = 3;  // in the picture's units

// From blue to orange, which colour-blind eyes keep apart; t in [0, 1].
std::string colourAt(double t) {
    const auto mix = [t](int from, int to) {
        return static_cast<int>(from + (to - from) * t + 0.5);
    };
    return fmt::format("#{:02x}{:02x}{:02x}", mix(0x00, 0xe6), mix(0x72, 0x9f), mix(0xb2, 0x00));
}

std::string panel(const BucketOrder& order, int left, int top, std::int32_t columns,
                  std::int32_t rows) {
    std::string svg = fmt::format(
        "<text x=\"{}\" y=\"{}\" fill=\"black\">{}</text>\n<rect x=\"{}\" y=\"{}\" width=\"{}\" "
        "height=\"{}\" "
        "fill=\"#f4f4f4\"/>\n",
        left, top - 7, order.name, left, top, columns * kCell, rows * kCell);
    const auto cells = order.cells(columns, rows, 1);
    const auto xOf = [&](std::uint32_t cell) {
        return left + static_cast<int>(cell) % columns * kCell + kCell / 2;
    };
    const auto yOf = [&](std::uint32_t cell) {
        return top + static_cast<int>(cell) / columns * kCell + kCell / 2;
    };
    // A few colours, each one path: small, and the same to the eye.
    constexpr std::size_t kColours = 16;
    for (std::size_t c = 0; c < kColours; ++c) {
        const std::size_t from = cells.size() * c / kColours;
        const std::size_t to = std::min(cells.size() * (c + 1) / kColours, cells.size() - 1);
        std::string path;
        for (std::size_t i = from; i <= to; ++i)
            path += fmt::format("{}{} {}", i == from ? "M" : "L", xOf(cells[i]), yOf(cells[i]));
        svg += fmt::format("<path d=\"{}\" stroke=\"{}\"/>\n", path,
                           colourAt(static_cast<double>(c) / (kColours - 1.0)));
    }
    return svg + fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"4\" fill=\"{}\"/>\n",
                             xOf(cells.front()), yOf(cells.front()), colourAt(0));
}

}  // namespace

void drawOrders(const std::filesystem::path& file, std::int32_t columns, std::int32_t rows) {
    std::string panels;
    int count = 0;
    for (const BucketOrder& order : bucketOrders()) {
        if (order.isCorrelated) continue;
        panels += panel(order, kGap + count % kPanelsPerRow * (columns * kCell + kGap),
                        kGap + count / kPanelsPerRow * (rows * kCell + kGap), columns, rows);
        ++count;
    }
    const int width = kGap + kPanelsPerRow * (columns * kCell + kGap);
    const int height = kGap + (count + kPanelsPerRow - 1) / kPanelsPerRow * (rows * kCell + kGap);
    std::ofstream out(file);
    out << fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
        "height=\"{1}\" font-family=\"sans-serif\" font-size=\"12\">\n"
        "<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n"
        "<g fill=\"none\" stroke-width=\"2\" stroke-linecap=\"round\">\n",
        width, height);
    out << panels << "</g>\n</svg>\n";
    if (!out.flush()) throw Error(Status::kIo, file.string() + ": can't be written");
}

}  // namespace pm::bench
