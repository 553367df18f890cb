// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/plot/log_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tests/bench/plot/svg_parts.h"

namespace pm::bench {

namespace {

constexpr double kWidth = 760, kHeight = 440;                        // of the picture, in its units
constexpr double kLeft = 70, kRight = 225, kTop = 36, kBottom = 50;  // margins

// One logarithmic axis: value -> place.
struct Axis {
    double low, high;  // logarithms of its ends, base 10
    double from, to;   // where they lie

    double place(double value) const {
        return from + (to - from) * (std::log10(value) - low) / (high - low);
    }
};

// Room for all values, with a little air; at least a decade.
Axis axisFor(const std::vector<double>& values, double from, double to) {
    double low = 0, high = 0;
    if (!values.empty()) {
        const auto [smallest, largest] = std::minmax_element(values.begin(), values.end());
        low = std::log10(*smallest) - 0.1;
        high = std::log10(*largest) + 0.1;
    }
    const double missing = std::max(0.0, 1 - (high - low));
    return {low - missing / 2, high + missing / 2, from, to};
}

// 1, 2 and 5 times powers of ten, as people write them.
std::string tickText(double value) {
    if (value > 0.009 && value < 1e4) return fmt::format("{:g}", value);
    const int decade = static_cast<int>(std::floor(std::log10(value) + 1e-9));
    return fmt::format("{:.0f}e{}", value / std::pow(10.0, decade), decade);
}

// Calls f(value, whether it has a number) for the axis's grid lines.
template <typename F>
void forTicks(const Axis& axis, const F& f) {
    const double decades = axis.high - axis.low;
    const bool all = decades < 2.5;
    const int everyDecade = decades > 9 ? 2 : 1;  // numbers need room
    for (int decade = static_cast<int>(std::floor(axis.low)); decade <= axis.high; ++decade)
        for (int digit = 1; digit < 10; ++digit) {
            const double value = std::pow(10.0, decade) * digit;
            if (std::log10(value) < axis.low || std::log10(value) > axis.high) continue;
            if (digit > 1 && decades > 6) continue;
            f(value,
              (digit == 1 && decade % everyDecade == 0) || (all && (digit == 2 || digit == 5)));
        }
}

std::string grid(const Axis& x, const Axis& y) {
    std::string svg;
    const auto style = [](bool strong) {
        return fmt::format("stroke=\"{}\" stroke-width=\"1\"", strong ? "#c8c8c8" : "#ececec");
    };
    forTicks(x, [&](double value, bool numbered) {
        const double at = x.place(value);
        svg += straight(at, y.from, at, y.to, style(numbered));
        if (numbered) svg += textAt(at, y.from + 16, "middle", tickText(value));
    });
    forTicks(y, [&](double value, bool numbered) {
        const double at = y.place(value);
        svg += straight(x.from, at, x.to, at, style(numbered));
        if (numbered) svg += textAt(x.from - 6, at + 4, "end", tickText(value));
    });
    return svg;
}

std::string curve(const PlotLine& line, const Axis& x, const Axis& y, const char* colour) {
    std::string path, dots;
    for (const auto& [px, py] : line.points) {
        if (!(px > 0) || !(py > 0)) continue;
        const double at = x.place(px), up = y.place(py);
        path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : " L", at, up);
        dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.6\" fill=\"{}\"/>\n", at, up,
                            colour);
    }
    return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\"{}/>\n{}",
                       path, colour, line.dashed ? " stroke-dasharray=\"6 4\"" : "", dots);
}

std::string legendEntry(const PlotLine& line, std::size_t index, double x, const char* colour) {
    const double y = kTop + 14 + 20 * static_cast<double>(index);
    const std::string style = fmt::format("stroke=\"{}\" stroke-width=\"2\"{}", colour,
                                          line.dashed ? " stroke-dasharray=\"6 4\"" : "");
    return straight(x, y, x + 24, y, style) + textAt(x + 30, y + 4, "start", line.name);
}

}  // namespace

void writeSvg(const std::filesystem::path& file, const LogPlot& plot) {
    std::vector<double> xs, ys;
    for (const PlotLine& line : plot.lines)
        for (const auto& [x, y] : line.points)
            if (x > 0 && y > 0) {
                xs.push_back(x);
                ys.push_back(y);
            }
    if (plot.level > 0) ys.push_back(plot.level);
    const Axis x = axisFor(xs, kLeft, kWidth - kRight), y = axisFor(ys, kHeight - kBottom, kTop);
    std::string svg;
    svg += grid(x, y);
    svg += textAt((x.from + x.to) / 2, 22, "middle", plot.title, "font-size=\"15\"");
    svg += textAt((x.from + x.to) / 2, kHeight - 14, "middle", plot.xLabel);
    svg +=
        textAt(0, 0, "middle", plot.yLabel,
               fmt::format("transform=\"translate(18 {:.1f}) rotate(-90)\"", (y.from + y.to) / 2));
    if (plot.level > 0) {
        const double at = y.place(plot.level);
        svg += straight(x.from, at, x.to, at, "stroke=\"#707070\" stroke-dasharray=\"2 3\"");
        svg += textAt(x.to + 6, at + 4, "start", plot.levelName, "fill=\"#707070\"");
    }
    for (std::size_t i = 0; i < plot.lines.size(); ++i) {
        const char* const colour = plotColour(i);
        svg += curve(plot.lines[i], x, y, colour);
        svg += legendEntry(plot.lines[i], i, x.to + 12, colour);
    }
    writeSvgFile(file, kWidth, kHeight, svg);
}

}  // namespace pm::bench
