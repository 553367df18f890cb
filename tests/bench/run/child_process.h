// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pm::bench {

struct ChildResult {
    int exitCode = 0;  // 128 + signal when a signal ended it
    double seconds = 0;
    double processorSeconds = 0;  // user and system, its own children included
};

// Runs arguments[0], found in PATH when it has no slash, in `folder`, and waits; what it prints
// goes to the file `log`, it reads nothing. Throws Error(kInternal) when it can't be started.
ChildResult runChild(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                     const std::filesystem::path& log);

// The last line of a log that has anything in it, to say why a program failed.
std::string lastLineOf(const std::filesystem::path& log);

// Where a program is in PATH.
std::optional<std::filesystem::path> findProgram(const std::string& name);

// A new folder of its own under the system's temporary one; deleted with everything in it.
class TemporaryFolder {
  public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return m_path; }

  private:
    std::filesystem::path m_path;
};

}  // namespace pm::bench
