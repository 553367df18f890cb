// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>

namespace pm::host {

// Names by numbers: what a million entries name is stored and looked for once. A tree, since
// whoever wrote the names may have chosen them so that hashes are alike.
class NameTable {
  public:
    static constexpr std::uint32_t kNone = 0xffffffffu;

    NameTable() = default;
    NameTable(NameTable&&) = default;
    NameTable& operator=(NameTable&&) = default;
    NameTable(const NameTable&) = delete;
    NameTable& operator=(const NameTable&) = delete;
    ~NameTable() = default;

    // The number of a name, a new one the first time: 0, 1, 2 ...
    std::uint32_t numberOf(std::string_view name) {
        const auto found = m_numbers.find(name);
        if (found != m_numbers.end()) return found->second;
        const auto number = static_cast<std::uint32_t>(m_names.size());
        m_numbers.emplace(m_names.emplace_back(name), number);
        return number;
    }
    // kNone where it was never given a number.
    std::uint32_t find(std::string_view name) const {
        const auto found = m_numbers.find(name);
        return found == m_numbers.end() ? kNone : found->second;
    }
    const std::string& operator[](std::uint32_t number) const { return m_names[number]; }
    std::size_t size() const { return m_names.size(); }

  private:
    std::deque<std::string> m_names;  // which stay where they are
    std::map<std::string_view, std::uint32_t> m_numbers;
};

}  // namespace pm::host
