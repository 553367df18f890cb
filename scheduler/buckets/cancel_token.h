// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <memory>

namespace pm {

// A flag shared by everyone who holds a copy: whoever sets it asks all the others to stop soon.
// Copies are handles of the same flag. It can't be taken back; another render wants another token.
// Threads: every member may be called from any thread at any time, also from several at once.
class CancelToken {
  public:
    CancelToken() : m_flag(std::make_shared<std::atomic<bool>>(false)) {}

    // Asks to stop; again does no harm.
    void cancel() const noexcept { m_flag->store(true, std::memory_order_release); }

    bool cancelled() const noexcept { return m_flag->load(std::memory_order_acquire); }

  private:
    std::shared_ptr<std::atomic<bool>> m_flag;
};

}  // namespace pm
