// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <stdexcept>
#include <string>

namespace pm::host {

// What pm_host exits with when the error reaches the top.
enum class ExitCode : int {
    kInternal = 1,  // a fault of ours
    kUsage = 2,     // an option is wrong
    kBadInput = 3,  // the scene, a config, a reference or another input is bad
    kFile = 4,      // a file can't be read or written
    kMemory = 5,    // more would be needed than there is, or than may be taken
};

// The one exception of the host. The text is one line that says what was given, what is allowed and
// where; it does not begin with the program's name.
class HostError : public std::runtime_error {
  public:
    HostError(ExitCode code, const std::string& text) : std::runtime_error(text), m_code(code) {}
    ExitCode code() const { return m_code; }
    int exitCode() const { return static_cast<int>(m_code); }

  private:
    ExitCode m_code;
};

}  // namespace pm::host
