// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <set>
#include <string>

namespace pm::host {

// The keys of an object that is being read: a table once there are many.
class KeySet {
  public:
    // False where it was there.
    bool insert(const std::string& key) {
        if (!m_many.empty()) return m_many.insert(key).second;
        for (std::size_t i = 0; i < m_fewCount; ++i)
            if (m_few[i] == key) return false;
        if (m_fewCount < m_few.size()) {
            m_few[m_fewCount++] = key;
            return true;
        }
        m_many.insert(m_few.begin(), m_few.end());
        return m_many.insert(key).second;
    }
    void clear() {
        m_many.clear();
        m_fewCount = 0;
    }

  private:
    std::array<std::string, 16> m_few;  // their memory is used again
    std::size_t m_fewCount{};
    std::set<std::string> m_many;  // empty: they are few
};

}  // namespace pm::host
