// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/log.h"

#include "host_shim/pictures/host_error.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace pm::host {
namespace {

constexpr std::uint64_t kShownOfEachCode = 5;

void toStandardError(std::string_view text) {
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

}  // namespace

double residentMemoryMib() {
    std::ifstream file("/proc/self/statm");
    std::string size, resident;
    file >> size >> resident;
    const double pages = resident.empty() ? 0 : static_cast<double>(std::stoll(resident));
    return pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1024 * 1024);
}

Log::Log(const Settings& settings) : m_settings(settings) {}

void Log::openFile(const std::filesystem::path& file) {
    m_file.open(file, std::ios::binary | std::ios::trunc);
    if (!m_file) {
        throw HostError(ExitCode::kFile,
                        fmt::format("{}: the log can't be written", file.string()));
    }
}

double Log::elapsedSeconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - m_start).count();
}

void Log::message(Level level, std::string_view text) {
    std::string line(text);
    // Names come from files: none may end the line or speak to the terminal.
    const auto isControl = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
    std::ranges::replace_if(
        line, [](char c) { return c == '\n' || c == '\t'; }, ' ');
    std::ranges::replace_if(line, isControl, '?');
    const char* colour = nullptr;
    if (level == Level::kError) {
        line = "pm_host: " + line;
        colour = "\x1b[31m";
    } else if (level == Level::kWarning) {
        line = "pm_host: warning: " + line;
        colour = "\x1b[33m";
    } else {
        line =
            fmt::format("[{:8.2f} s {:6.0f} MiB] {}", elapsedSeconds(), residentMemoryMib(), line);
    }
    if (m_file.is_open()) m_file << line << '\n' << std::flush;
    if (level >= m_settings.leastLevel) write(line, colour);
}

void Log::warning(int code, std::string_view text) {
    WarningCount& warning = m_warnings[code];
    if (warning.count++ == 0) warning.firstText = text;
    if (warning.count <= kShownOfEachCode) message(Level::kWarning, text);
}

void Log::libraryWarning(int code, std::string_view text) {
    warning(code, m_subject.empty() ? std::string(text) : fmt::format("{}: {}", m_subject, text));
}

void Log::reportHiddenWarnings() {
    for (const auto& [code, warning] : m_warnings) {
        if (warning.count <= kShownOfEachCode) continue;
        message(Level::kWarning, fmt::format("{} more of the kind of: {}",
                                             warning.count - kShownOfEachCode, warning.firstText));
    }
}

void Log::write(std::string_view text, const char* colour) {
    std::string line = m_hasStatusLine ? "\r\x1b[K" : "";
    m_hasStatusLine = false;
    if (m_settings.colours && colour != nullptr) {
        line.append(colour).append(text).append("\x1b[0m");
    } else {
        line.append(text);
    }
    toStandardError(line + "\n");
}

void Log::setStatusLine(std::string_view text) {
    if (text.empty() && !m_hasStatusLine) return;
    toStandardError(fmt::format("\r\x1b[K{}", text));
    m_hasStatusLine = !text.empty();
}

void Log::rawLine(std::string_view text) {
    write(text, nullptr);
}

}  // namespace pm::host
