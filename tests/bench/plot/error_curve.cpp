// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/plot/error_curve.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>

#include "integrator/values/error.h"
#include "tests/bench/plot/report.h"

namespace pm::bench {

namespace {

constexpr const char* kHead = "scene,renderer,budget,seconds,processor seconds,relMSE";

std::vector<std::string> cellsOf(const std::string& line) {
    std::vector<std::string> cells(1);
    for (const char c : line)
        if (c == ',')
            cells.emplace_back();
        else
            cells.back() += c;
    return cells;
}

bool readNumber(const std::string& text, double& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

std::optional<Reached> reach(double error, const ErrorCurve& curve) {
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
        const ErrorPoint& b = curve.points[i];
        if (!(b.error <= error)) continue;
        if (i == 0) return Reached{b.seconds, b.processorSeconds, true};
        const ErrorPoint& a = curve.points[i - 1];
        const double t = std::log(a.error / error) / std::log(a.error / b.error);
        const auto between = [t](double from, double to) { return from * std::pow(to / from, t); };
        return Reached{between(a.seconds, b.seconds),
                       between(a.processorSeconds, b.processorSeconds)};
    }
    return {};
}

std::string secondsTo(double error, const ErrorCurve& curve) {
    const std::optional<Reached> at = reach(error, curve);
    if (!at) return "-";
    return fmt::format("{}{} ({})", at->byFirst ? "< " : "", show(at->seconds),
                       show(at->processorSeconds));
}

std::vector<ErrorCurve> readCurves(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::vector<ErrorCurve> curves;
    std::string line;
    std::getline(in, line);
    for (int number = 2; std::getline(in, line); ++number) {
        const std::vector<std::string> cells = cellsOf(line);
        ErrorPoint point;
        if (cells.size() != 6 || !readNumber(cells[3], point.seconds) ||
            !readNumber(cells[4], point.processorSeconds) || !readNumber(cells[5], point.error))
            throw Error(Status::kIo,
                        fmt::format("{}:{}: '{}'; wanted: {}", file.string(), number, line, kHead));
        point.budget = cells[2];
        if (curves.empty() || curves.back().scene != cells[0] || curves.back().renderer != cells[1])
            curves.push_back({cells[0], cells[1], {}});
        curves.back().points.push_back(point);
    }
    return curves;
}

void writeCurves(const std::filesystem::path& file, const std::vector<ErrorCurve>& curves) {
    std::ofstream out(file);
    out << kHead << '\n';
    for (const ErrorCurve& curve : curves)
        for (const ErrorPoint& p : curve.points)
            out << fmt::format("{},{},{},{:.4g},{:.4g},{:.4g}\n", curve.scene, curve.renderer,
                               p.budget, p.seconds, p.processorSeconds, p.error);
    if (!out.flush()) throw Error(Status::kIo, file.string() + ": can't be written");
}

}  // namespace pm::bench
