// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/plot/report.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <stdlib.h>

#include <cstdio>
#include <ctime>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

#include "integrator/values/error.h"

namespace pm::bench {

namespace {

std::string processorName() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        const auto colon = line.find(": ");
        if (line.starts_with("model name") && colon != std::string::npos)
            return line.substr(colon + 2);
    }
    return "unknown processor";
}

std::string quoted(const std::string& cell) {
    std::string text(1, '"');
    for (const char c : cell) text.append(c == '"' ? 2 : 1, c);
    text += '"';
    return text;
}

std::string joined(const std::vector<std::string>& cells, bool csv) {
    if (!csv) return fmt::format("| {} |\n", fmt::join(cells, " | "));
    std::vector<std::string> safe;
    for (const std::string& cell : cells) safe.push_back(quoted(cell));
    return fmt::format("{}\n", fmt::join(safe, ","));
}

std::string readAll(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw Error(Status::kIo, file + ": can't be read");
    return {std::istreambuf_iterator<char>(in), {}};
}

void writeAll(const std::string& file, const std::string& text) {
    std::ofstream out(file, std::ios::binary);
    out << text;
    if (!out.flush()) throw Error(Status::kIo, file + ": can't be written");
}

// The document with what the report's place in it held replaced.
std::string withReport(const std::string& docs, const std::string& file, const Report& report) {
    const std::string begin = fmt::format("<!-- {} begin -->\n", report.name());
    const std::string end = fmt::format("<!-- {} end -->", report.name());
    const auto from = docs.find(begin), to = docs.find(end);
    if (from == std::string::npos || to == std::string::npos || to < from)
        throw Error(Status::kIo, fmt::format("{}: needs the lines '<!-- {} begin -->' and '{}'",
                                             file, report.name(), end));
    return fmt::format("{}\n{}\n{}", docs.substr(0, from + begin.size()), report.markdown(),
                       docs.substr(to));
}

}  // namespace

void Report::paragraph(const std::string& text) {
    m_tables.push_back({text, {}, {}});
}

void Report::table(const std::string& title, std::vector<std::string> header) {
    fmt::print(stderr, "{}\n", title);
    m_tables.push_back({title, std::move(header), {}});
}

void Report::row(std::vector<std::string> cells) {
    fmt::print(stderr, "  {}\n", fmt::join(cells, " | "));
    if (cells.size() != m_tables.back().header.size())
        throw std::logic_error(fmt::format("a row of {} cells in a table of {} columns",
                                           cells.size(), m_tables.back().header.size()));
    m_tables.back().rows.push_back(std::move(cells));
}

std::string Report::markdown() const {
    std::string text = fmt::format("{}\n", machineLine());
    for (const Table& table : m_tables) {
        text += fmt::format("\n{}\n", table.title);
        if (table.header.empty()) continue;
        text += fmt::format("\n{}", joined(table.header, false));
        text += joined(std::vector<std::string>(table.header.size(), "---"), false);
        for (const auto& cells : table.rows) text += joined(cells, false);
    }
    return text;
}

std::string Report::csv() const {
    std::string text;
    for (const Table& table : m_tables) {
        if (table.header.empty()) continue;
        const auto line = [&](std::vector<std::string> cells, const std::string& first) {
            cells.insert(cells.begin(), first);
            text += joined(cells, true);
        };
        line(table.header, "table");
        for (const auto& cells : table.rows) line(cells, table.title);
    }
    return text;
}

void Report::publish(const std::string& csvFile, const std::string& docsFile) const {
    bench::publish({this, 1}, csvFile, docsFile);
}

void publish(std::span<const Report> reports, const std::string& csvFile,
             const std::string& docsFile) {
    std::string csv;
    for (const Report& report : reports) {
        fmt::print("{}", report.markdown());
        csv += report.csv();
    }
    if (!csvFile.empty()) writeAll(csvFile, csv);
    if (docsFile.empty()) return;
    std::string docs = readAll(docsFile);
    for (const Report& report : reports) docs = withReport(docs, docsFile, report);
    writeAll(docsFile, docs);
}

std::string machineLine() {
    double load[3] = {0, 0, 0};
    if (getloadavg(load, 3) < 3) load[0] = load[1] = load[2] = 0;
#ifdef NDEBUG
    const char* build = "Release";
#else
    const char* build = "with assertions";
#endif
    return fmt::format(
        "{}, {} processors, {}, GCC {}, {:%Y-%m-%d} UTC; load average over the last 1, 5 and 15 "
        "minutes (this run included): {:.1f}, {:.1f}, {:.1f}.",
        processorName(), std::thread::hardware_concurrency(), build, __VERSION__,
        fmt::gmtime(std::time(nullptr)), load[0], load[1], load[2]);
}

std::string show(double value) {
    const double size = value < 0 ? -value : value;
    if (size == 0) return "0";
    if (size < 0.01) return fmt::format("{:.2e}", value);
    if (size < 1) return fmt::format("{:.3f}", value);
    if (size < 10) return fmt::format("{:.2f}", value);
    if (size < 100) return fmt::format("{:.1f}", value);
    return fmt::format("{:.0f}", value);
}

std::string show(const Spread& spread, double scale) {
    return fmt::format("{} ({} to {})", show(spread.median * scale), show(spread.lower * scale),
                       show(spread.upper * scale));
}

}  // namespace pm::bench
