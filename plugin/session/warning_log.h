// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace pm::plugin {

// Warnings by code, for the statistics: each counted, the first texts kept. Threads: any.
class WarningLog {
  public:
    static constexpr std::size_t kTextsKept = 10;

    struct Entry {
        std::uint64_t count = 0;
        std::vector<std::string> texts;  // without repetitions
    };

    void add(std::int32_t code, const std::string& text) {
        const std::lock_guard lock(m_mutex);
        Entry& entry = m_entries[code];
        ++entry.count;
        for (const std::string& known : entry.texts)
            if (known == text) return;
        if (entry.texts.size() < kTextsKept) entry.texts.push_back(text);
    }

    std::map<std::int32_t, Entry> entries() const {
        const std::lock_guard lock(m_mutex);
        return m_entries;
    }

  private:
    mutable std::mutex m_mutex;
    std::map<std::int32_t, Entry> m_entries;
};

}  // namespace pm::plugin
