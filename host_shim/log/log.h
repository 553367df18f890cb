// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace pm::host {

enum class Level { kDebug, kInfo, kWarning, kError };

// How often a warning came, and what it said first.
struct WarningCount {
    std::uint64_t count{};
    std::string firstText;
};

// Messages for people: to standard error, and all of them to a log file where one is wanted. Info
// lines begin with elapsed time and memory. For one thread at a time.
class Log {
  public:
    struct Settings {
        Level leastLevel{Level::kInfo};
        bool colours{};
    };
    explicit Log(const Settings& settings);
    ~Log();
    Log(const Log&) = delete;
    Log& operator=(const Log&) = delete;

    // Settings become known after the log is needed.
    void configure(const Settings& settings) { m_settings = settings; }
    // Errors: kFile.
    void openFile(const std::filesystem::path& file);
    // Whether a line did not get into the file, which was told once; one that stayed empty is gone.
    bool fileFailed() const { return m_fileError != 0; }

    void message(Level level, std::string_view text);
    void info(std::string_view text) { message(Level::kInfo, text); }
    // Counted by code; of each code the first few are shown, the rest only counted.
    void warning(int code, std::string_view text);
    // What the library's warnings are about until the next call; empty: they say it themselves.
    void setSubject(std::string_view subject) { m_subject = subject; }
    void libraryWarning(int code, std::string_view text);
    // Says how many warnings were only counted.
    void reportHiddenWarnings();

    // A line that stands until the next one or a message takes its place; for progress bars.
    void setStatusLine(std::string_view text);
    // A line of its own to standard error, as it is.
    void rawLine(std::string_view text);

    double elapsedSeconds() const;
    const std::map<int, WarningCount>& warnings() const { return m_warnings; }

  private:
    void write(std::string_view text, const char* colour);
    void writeToFile(std::string_view line);

    Settings m_settings;
    std::chrono::steady_clock::time_point m_start{std::chrono::steady_clock::now()};
    std::filesystem::path m_fileName;
    int m_file{-1};
    int m_fileError{};  // the first errno
    std::map<int, WarningCount> m_warnings;
    std::string m_subject;
    bool m_hasStatusLine{};
};

// Resident memory of this process in MiB, 0 where it is unknown.
double residentMemoryMib();

}  // namespace pm::host
