// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <string>

#include "integrator/values/error.h"

namespace pm {

// Whether work is to be given up: looks at a flag that another thread sets, or never is. A plain
// value; the flag must outlive it. Threads: any.
class CancelCheck {
  public:
    CancelCheck() = default;
    explicit CancelCheck(const std::atomic<bool>& flag) : m_flag(&flag) {}

    bool isSet() const { return m_flag != nullptr && m_flag->load(std::memory_order_relaxed); }
    // Throws Error(kCancelled), "cancelled while " and what.
    void throwIfSet(const char* what) const {
        if (isSet()) throw Error(Status::kCancelled, std::string("cancelled while ") + what);
    }

  private:
    const std::atomic<bool>* m_flag = nullptr;
};

}  // namespace pm
