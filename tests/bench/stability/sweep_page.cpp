// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/stability/sweep_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "integrator/values/error.h"
#include "tests/bench/plot/log_plot.h"

namespace pm::bench {

namespace {

constexpr double kLeastShown = 1e-9;  // of errors, on a logarithmic axis

std::size_t pointCount(std::span<const SweepResult> results) {
    std::size_t count = 0;
    for (const SweepResult& result : results) count += result.points.size();
    return count;
}

void writeText(const std::filesystem::path& file, const std::string& text) {
    std::ofstream out(file);
    out << text;
    out.close();
    if (!out) throw Error(Status::kIo, "cannot write " + file.string());
}

// Words with dashes between, for files.
std::string fileName(const SweepResult& result) {
    std::string name = result.sweep.kind + "_" + result.sweep.name;
    for (char& c : name)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_') c = '-';
    return name;
}

std::string csvOf(std::span<const SweepResult> results) {
    std::string csv =
        "kind,name,variant,parameter,value,measured,expected,error,standard_error,z,seeds,"
        "has_to_be_flat\n";
    for (const SweepResult& result : results)
        for (const SweepPoint& p : result.points)
            csv += fmt::format("{},{},{},\"{}\",{:g},{:.9g},{:.9g},{:.4g},{:.4g},{:.3g},{},{}\n",
                               result.sweep.kind, result.sweep.name, result.sweep.variant,
                               result.sweep.parameter, p.value, p.measured, p.expected, p.error,
                               p.standardError, p.z, result.seeds,
                               result.sweep.hasToBeFlatAt(p.value) ? 1 : 0);
    return csv;
}

// Sweeps that share a plot follow each other.
LogPlot plotOf(std::span<const SweepResult> results) {
    const Sweep& first = results.front().sweep;
    LogPlot plot;
    plot.title = first.kind + ": " + first.name;
    plot.xLabel = first.parameter;
    plot.yLabel = first.isCount ? "faults" : "error, relative";
    for (const SweepResult& result : results) {
        const std::string of =
            result.sweep.variant.empty() ? "" : " (" + result.sweep.variant + ")";
        PlotLine error{"error" + of, {}}, noise{"standard error" + of, {}, true};
        for (const SweepPoint& p : result.points) {
            error.points.emplace_back(p.value, std::max(std::abs(p.error), kLeastShown));
            noise.points.emplace_back(p.value, std::max(p.standardError, kLeastShown));
        }
        plot.lines.push_back(std::move(error));
        if (!first.isCount) plot.lines.push_back(std::move(noise));
    }
    if (!first.isCount) {
        plot.level = kSweepRounding;
        plot.levelName = "rounding";
    }
    return plot;
}

std::string rangeOf(const SweepResult& result) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const SweepPoint& p : result.points)
        if (result.sweep.hasToBeFlatAt(p.value) && p.value != result.sweep.flatAlso) {
            low = std::min(low, p.value);
            high = std::max(high, p.value);
        }
    const std::string also =
        result.sweep.flatAlso ? fmt::format(" and {:.3g}", *result.sweep.flatAlso) : "";
    return low > high ? "nowhere" : fmt::format("{:.3g} to {:.3g}{}", low, high, also);
}

std::string rowOf(const SweepResult& result, double limit) {
    const SweepPoint& worst = result.worst();
    const auto largest = std::ranges::max(result.points, {}, [&](const SweepPoint& p) {
        return result.sweep.hasToBeFlatAt(p.value) ? std::abs(p.error) : -1;
    });
    const std::string reported =
        result.sweep.reported.empty() ? "" : " (" + result.sweep.reported + ")";
    return fmt::format("| {} {} | {}{} | {} | {:.2g} at {:.3g} | {:.2g} | {:.1f} | {} |\n",
                       result.sweep.name, result.sweep.variant, result.sweep.against, reported,
                       rangeOf(result), std::abs(largest.error), largest.value,
                       largest.standardError, worst.z,
                       result.isFlat(limit) ? "flat" : "**not flat**");
}

// The largest error beyond what has to be flat, and why.
std::string limitOf(const SweepResult& result) {
    const SweepPoint* worst = nullptr;
    for (const SweepPoint& p : result.points)
        if (!result.sweep.hasToBeFlatAt(p.value) &&
            (!worst || !(std::abs(p.error) <= std::abs(worst->error))))
            worst = &p;
    if (!worst) return "";
    const Sweep& sweep = result.sweep;
    const std::string reason =
        static_cast<char>(std::toupper(sweep.limit[0])) + sweep.limit.substr(1);
    return fmt::format("- **{}, {}{}{}**: {} Flat: {}. {} {:.2g} +- {:.1g} at {:.3g}.\n",
                       sweep.kind, sweep.name, sweep.variant.empty() ? "" : ", ", sweep.variant,
                       reason, rangeOf(result), sweep.isCount ? "Faults:" : "Off by",
                       std::abs(worst->error), worst->standardError, worst->value);
}

constexpr const char* kIntroduction =
    "# Numerical stability\n\n"
    "Written by `./dev bench stability`; a part of it is in the suite, `pm_test_stability`. Each\n"
    "sweep renders a small scene that gets worse and worse conditioned and holds it against a "
    "twin\n"
    "that is not, or against a closed form. The error is relative, the standard error comes from\n"
    "{} independent seeds, each compared with the twin of the same seed. z is the error in "
    "standard\n"
    "errors beyond rounding ({:.1g}, 64 roundings of a float), as the normal number that is as "
    "rare\n"
    "as Student's t; a sweep is flat where no z is beyond {:.1f}, which of {} points chance alone\n"
    "brings once in a hundred times. Sweeps of faults (leaks, pinholes, specks, values that are "
    "no\n"
    "numbers, flux lost) count them; there are to be none. Where an error is drawn at 1e-9 there "
    "is\n"
    "none. In parentheses: issues in which users of other renderers met the case. All points are "
    "in [lab/{}.csv](lab/{}.csv).\n";

}  // namespace

void writeSweepPage(const std::filesystem::path& page, std::span<const SweepResult> results) {
    const std::string name = page.stem().string();
    const auto images = page.parent_path() / "images" / name, lab = page.parent_path() / "lab";
    std::filesystem::create_directories(images);
    std::filesystem::create_directories(lab);
    writeText(lab / (name + ".csv"), csvOf(results));
    const std::size_t count = pointCount(results);
    const double limit = limitOfChance(count);
    std::string text = fmt::format(fmt::runtime(kIntroduction), results.front().seeds,
                                   kSweepRounding, limit, count, name, name);
    std::string limits, plots, table;
    for (std::size_t i = 0, end = 0; i < results.size(); i = end) {
        const Sweep& first = results[i].sweep;
        for (end = i; end < results.size() && fileName(results[end]) == fileName(results[i]);
             ++end) {
            table += rowOf(results[end], limit);
            limits += limitOf(results[end]);
        }
        writeSvg(images / (fileName(results[i]) + ".svg"), plotOf(results.subspan(i, end - i)));
        plots += fmt::format("![{0}: {1}](images/{2}/{3}.svg)\n", first.kind, first.name, name,
                             fileName(results[i]));
        if (end < results.size() && results[end].sweep.kind == first.kind) continue;
        text += fmt::format("\n## {}{}\n\n", static_cast<char>(std::toupper(first.kind[0])),
                            first.kind.substr(1));
        text +=
            "| sweep | against | flat from, to | largest error | its standard error | largest z "
            "| outcome |\n|---|---|---|---|---|---|---|\n" +
            table + "\n" + plots;
        table.clear();
        plots.clear();
    }
    text += "\n## Limits that remain\n\n" + (limits.empty() ? "None.\n" : limits);
    writeText(page, text);
}

std::string outcomeLine(const SweepResult& result, double limit) {
    const SweepPoint& worst = result.worst();
    return fmt::format(
        "{:<10} {:<28} {:<7} {:<9} worst z {:5.1f} at {:<8.3g} error {:9.2g} +- {:.2g}",
        result.sweep.kind, result.sweep.name, result.sweep.variant,
        result.isFlat(limit) ? "flat" : "NOT FLAT", worst.z, worst.value, worst.error,
        worst.standardError);
}

}  // namespace pm::bench
