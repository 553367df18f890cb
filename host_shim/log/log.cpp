// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/log/log.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "host_shim/process/plain_text.h"
#include "host_shim/values/host_error.h"

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

Log::~Log() {
    if (m_file >= 0) ::close(m_file);
}

void Log::openFile(const std::filesystem::path& file) {
    if (m_file >= 0) ::close(m_file);  // that of the frame before
    m_fileName = file;
    m_file = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0666);
    if (m_file < 0) {
        throw HostError(ExitCode::kFile, fmt::format("{}: the log can't be written: {}",
                                                     file.string(), std::strerror(errno)));
    }
}

void Log::writeToFile(std::string_view line) {
    if (m_file < 0 || m_fileError != 0) return;
    std::string_view rest = line;
    while (!rest.empty()) {
        const ssize_t written = ::write(m_file, rest.data(), rest.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) {
            m_fileError = written < 0 ? errno : ENOSPC;
            break;
        }
        rest.remove_prefix(static_cast<std::size_t>(written));
    }
    if (m_fileError == 0) return;
    std::error_code ignored;
    if (::lseek(m_file, 0, SEEK_END) == 0)
        std::filesystem::remove(std::filesystem::canonical(m_fileName, ignored), ignored);
    message(Level::kError, fmt::format("{}: the log can't be written: {}", m_fileName.string(),
                                       std::strerror(m_fileError)));
}

double Log::elapsedSeconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - m_start).count();
}

void Log::message(Level level, std::string_view text) {
    // Names come from files: none may end the line or speak to the terminal.
    std::string line = plainText(withoutPasswords(text));
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
    if (level >= m_settings.leastLevel) write(line, colour);
    writeToFile(line + "\n");
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
