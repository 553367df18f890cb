// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <string>

namespace pm::host {

// Memory that what a text says may take. Not for several threads.
class JsonBudget {
  public:
    // For a text of so many bytes: a fixed multiple of it, and at most memoryLimit, which is what
    // --memory-limit says in bytes (0: nothing). file: for messages.
    JsonBudget(std::string file, std::uint64_t textBytes, std::uint64_t memoryLimit = 0);
    // By --memory-limit alone, for what is kept of a text.
    static JsonBudget ofLimit(std::string file, std::uint64_t memoryLimit);

    // Errors: HostError, exit code 3, or 5 where it is --memory-limit that is passed; the file, and
    // what is allowed.
    void take(std::uint64_t bytes) {
        m_used += bytes;
        if (m_used > m_most) refuse();
    }
    void giveBack(std::uint64_t bytes) { m_used -= bytes; }
    std::uint64_t used() const { return m_used; }
    const std::string& file() const { return m_file; }

  private:
    [[noreturn]] void refuse() const;

    std::string m_file;
    std::uint64_t m_most{};
    std::uint64_t m_used{};
    bool m_isMemoryLimit{};
};

}  // namespace pm::host
