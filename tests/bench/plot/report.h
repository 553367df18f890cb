// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tests/bench/run/timing.h"

namespace pm::bench {

// What a benchmark program found: tables for people (Markdown) and programs (CSV).
class Report {
  public:
    // name: of the place in docs/benchmarks.md that belongs to this program.
    explicit Report(std::string name) : m_name(std::move(name)) {}

    // A paragraph or a picture's line, in Markdown only.
    void paragraph(const std::string& text);
    // The rows that follow belong to this table.
    void table(const std::string& title, std::vector<std::string> header);
    // Also says on standard error that this row is done. As many cells as the header has; throws
    // std::logic_error.
    void row(std::vector<std::string> cells);

    const std::string& name() const { return m_name; }
    std::string markdown() const;
    std::string csv() const;
    // publish() of this one.
    void publish(const std::string& csvFile, const std::string& docsFile) const;

  private:
    struct Table {
        std::string title;
        std::vector<std::string> header;  // empty: a paragraph, its text is the title
        std::vector<std::vector<std::string>> rows;
    };
    std::string m_name;
    std::vector<Table> m_tables;
};

// Markdown to standard output, CSV of all to csvFile, and the Markdown of each between the lines
// <!-- NAME begin --> and <!-- NAME end --> of docsFile, so that the places of others stay; a file
// name that is empty is left out. Throws Error(kIo), naming the file and what is wrong with it.
void publish(std::span<const Report> reports, const std::string& csvFile,
             const std::string& docsFile);

// Processor, threads, build, date (UTC), and how busy the machine was, in one line.
std::string machineLine();

// "1.23 (1.20 to 1.25)": median and quartiles, each times `scale`.
std::string show(const Spread& spread, double scale = 1.0);
// Three significant digits.
std::string show(double value);

}  // namespace pm::bench
