// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Error over seconds of one renderer on one scene, and what is read off it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pm::bench {

struct ErrorPoint {
    std::string budget;  // in the renderer's own words: "16 samples"
    double seconds = 0, processorSeconds = 0;
    double error = 0;  // relMSE
};

struct ErrorCurve {
    std::string scene, renderer;
    std::vector<ErrorPoint> points;  // by rising budget
};

// Where a curve comes to an error, along a straight line between the logarithms of the points. At
// the first point when that is below already, and nothing when none is.
struct Reached {
    double seconds = 0, processorSeconds = 0;
    bool byFirst = false;  // so these are upper bounds
};
std::optional<Reached> reach(double error, const ErrorCurve& curve);

// "1.2 (2.3)": seconds to an error, and processor seconds in brackets; "< ..." when the first point
// is below, "-" when none is.
std::string secondsTo(double error, const ErrorCurve& curve);

// A file with one point a line: scene,renderer,budget,seconds,processor seconds,error. Reading a
// file that is not there gives nothing. Throw Error(kIo), naming the file and the line.
std::vector<ErrorCurve> readCurves(const std::filesystem::path& file);
void writeCurves(const std::filesystem::path& file, const std::vector<ErrorCurve>& curves);

}  // namespace pm::bench
