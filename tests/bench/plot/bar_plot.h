// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pm::bench {

struct Bar {
    double value = 0;   // > 0; others are left out
    bool pale = false;  // what was not measured itself
};

// Groups of bars side by side over a linear axis from 0.
struct BarPanel {
    std::string title, yLabel;
    std::vector<std::string> groups;     // names, from left to right
    std::vector<std::vector<Bar>> bars;  // of each series, one for each group
};

// Panels one below the other that share their series.
struct BarPlot {
    std::vector<std::string> series;  // names; the first eight have colours of their own
    std::vector<BarPanel> panels;
    std::string note;  // below the names of the series
};

// Writes the plot as an SVG file. Throws Error(kIo).
void writeSvg(const std::filesystem::path& file, const BarPlot& plot);

}  // namespace pm::bench
