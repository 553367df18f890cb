// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace pm::bench {

struct PlotLine {
    std::string name;
    std::vector<std::pair<double, double>> points;  // both > 0; others are left out
    bool dashed = false;
};

struct LogPlot {
    std::string title, xLabel, yLabel;
    std::vector<PlotLine> lines;  // the first eight have colours of their own
    double level = 0;             // a grey line across at this y; 0 = none
    std::string levelName;
};

// Writes the plot, both axes logarithmic, as an SVG file. Throws Error(kIo).
void writeSvg(const std::filesystem::path& file, const LogPlot& plot);

}  // namespace pm::bench
