// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/log/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pm::host {
namespace {

constexpr int kBarWidth = 30;

ProgressStyle decided(ProgressStyle style, bool quiet) {
    if (style != ProgressStyle::kAuto) return style;
    if (quiet) return ProgressStyle::kNone;
    return isatty(STDERR_FILENO) != 0 ? ProgressStyle::kBar : ProgressStyle::kPlain;
}

std::string remainingText(double seconds) {
    return std::isnan(seconds) ? "remaining time not known yet" : clockText(seconds) + " left";
}

}  // namespace

std::string clockText(double seconds) {
    const auto whole = static_cast<long long>(std::ceil(std::clamp(seconds, 0.0, 3.6e9)));
    if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

Progress::Progress(ProgressStyle style, bool quiet, Log& log)
    : m_style(decided(style, quiet)), m_log(log) {}

Progress::~Progress() {
    if (m_style == ProgressStyle::kBar) m_log.setStatusLine("");
}

void Progress::update(double fraction, double remainingSeconds) {
    if (m_style == ProgressStyle::kNone) return;
    const double interval = m_style == ProgressStyle::kBar ? 0.1 : 1.0;
    const double now = m_log.elapsedSeconds();
    const int percent = static_cast<int>(std::floor(std::clamp(fraction, 0.0, 1.0) * 100));
    const bool last = percent == 100 && m_shownPercent != 100;
    if (percent == m_shownPercent && m_style != ProgressStyle::kBar) return;
    if (now - m_shownAt < interval && !last) return;
    m_shownAt = now;
    m_shownPercent = percent;
    show(fraction, remainingSeconds);
}

void Progress::print(const std::string& lines) {
    std::fwrite(lines.data(), 1, lines.size(), stdout);
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return;
    // Nobody listens any more: no reason to end a render, and no failure of its results.
    std::clearerr(stdout);
    m_style = ProgressStyle::kNone;
    m_log.message(Level::kWarning, "standard output is closed; progress is not told any more");
}

void Progress::show(double fraction, double remainingSeconds) {
    const std::string remaining = remainingText(remainingSeconds);
    switch (m_style) {
        case ProgressStyle::kBar: {
            const int full = std::clamp(static_cast<int>(fraction * kBarWidth), 0, kBarWidth);
            m_log.setStatusLine(fmt::format("[{:#<{}}{:.<{}}] {:3}%  {}", "", full, "",
                                            kBarWidth - full, m_shownPercent, remaining));
            break;
        }
        case ProgressStyle::kJson:
            m_log.rawLine(fmt::format(
                R"({{"progress": {:.4f}, "elapsed_seconds": {:.2f}, "remaining_seconds": {}}})",
                fraction, m_log.elapsedSeconds(),
                std::isnan(remainingSeconds) ? "null" : fmt::format("{:.2f}", remainingSeconds)));
            break;
        case ProgressStyle::kAlf:
            print(fmt::format("ALF_PROGRESS {}%\n", m_shownPercent));
            break;
        case ProgressStyle::kOpenJd:
            // Open Job Description, "How Jobs Are Run": messages of a task on standard output.
            print(fmt::format("openjd_progress: {:.1f}\nopenjd_status: {}\n", fraction * 100,
                              fraction < 1 ? remaining : "done"));
            break;
        default:
            m_log.rawLine(fmt::format("Progress: {}%, {} elapsed, {}", m_shownPercent,
                                      clockText(std::floor(m_log.elapsedSeconds())), remaining));
    }
}

}  // namespace pm::host
