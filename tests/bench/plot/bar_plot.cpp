// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/plot/bar_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tests/bench/plot/svg_parts.h"

namespace pm::bench {

namespace {

constexpr double kWidth = 760, kPanelHeight = 230;                   // in the picture's units
constexpr double kLeft = 70, kRight = 170, kTop = 34, kBottom = 40;  // margins of a panel

// 1, 2 or 5 times a power of ten, so that the axis has four to ten lines.
double stepFor(double most) {
    const double power = std::pow(10.0, std::floor(std::log10(most / 4)));
    for (const double digit : {5.0, 2.0})
        if (digit * power <= most / 4) return digit * power;
    return power;
}

double largestOf(const BarPanel& panel) {
    double most = 0;
    for (const auto& series : panel.bars)
        for (const Bar& bar : series)
            if (bar.value > most) most = bar.value;
    return most > 0 ? most : 1;
}

std::string gridOf(double most, double top) {
    std::string svg;
    const double height = kPanelHeight - kTop - kBottom, step = stepFor(most);
    for (int i = 0; i * step <= most; ++i) {
        const double y = top + kTop + height * (1 - i * step / most);
        svg += straight(kLeft, y, kWidth - kRight, y, "stroke=\"#d8d8d8\"");
        svg += textAt(kLeft - 6, y + 4, "end", fmt::format("{:g}", i * step));
    }
    return svg;
}

std::string panelAt(const BarPanel& panel, double top) {
    const double most = 1.05 * largestOf(panel), height = kPanelHeight - kTop - kBottom;
    const double groupWidth = (kWidth - kLeft - kRight) /
                              static_cast<double>(std::max<std::size_t>(panel.groups.size(), 1));
    const double barWidth =
        0.8 * groupWidth / static_cast<double>(std::max<std::size_t>(panel.bars.size(), 1));
    std::string svg =
        textAt((kLeft + kWidth - kRight) / 2, top + 20, "middle", panel.title, "font-size=\"14\"") +
        gridOf(most, top);
    svg += textAt(
        0, 0, "middle", panel.yLabel,
        fmt::format("transform=\"translate(18 {:.1f}) rotate(-90)\"", top + kTop + height / 2));
    for (std::size_t g = 0; g < panel.groups.size(); ++g) {
        const double left = kLeft + groupWidth * (static_cast<double>(g) + 0.1);
        svg += textAt(left + 0.4 * groupWidth, top + kPanelHeight - kBottom + 16, "middle",
                      panel.groups[g]);
        for (std::size_t s = 0; s < panel.bars.size(); ++s) {
            const Bar& bar = panel.bars[s].at(g);
            if (!(bar.value > 0)) continue;
            const double tall = height * bar.value / most;
            svg += fmt::format(
                "<rect class=\"bar\" x=\"{:.1f}\" y=\"{:.2f}\" width=\"{:.1f}\" height=\"{:.2f}\" "
                "fill=\"{}\"{}/>\n",
                left + barWidth * static_cast<double>(s), top + kTop + height - tall, barWidth,
                tall, plotColour(s), bar.pale ? " fill-opacity=\"0.5\"" : "");
        }
    }
    return svg;
}

}  // namespace

void writeSvg(const std::filesystem::path& file, const BarPlot& plot) {
    std::string svg;
    for (std::size_t i = 0; i < plot.panels.size(); ++i)
        svg += panelAt(plot.panels[i], kPanelHeight * static_cast<double>(i));
    const double x = kWidth - kRight + 14;
    double y = kTop + 14;
    for (std::size_t s = 0; s < plot.series.size(); ++s, y += 20) {
        svg += fmt::format(
            "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"12\" height=\"12\" fill=\"{}\"/>\n", x, y - 10,
            plotColour(s));
        svg += textAt(x + 18, y, "start", plot.series[s]);
    }
    if (!plot.note.empty()) svg += textAt(x, y + 4, "start", plot.note, "fill=\"#606060\"");
    writeSvgFile(file, kWidth, kPanelHeight * static_cast<double>(plot.panels.size()), svg);
}

}  // namespace pm::bench
