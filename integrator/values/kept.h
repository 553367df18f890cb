// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <memory>
#include <mutex>

namespace pm {

// Something that was made of a value and is kept with it, for whoever needs it next; a copy of the
// value starts without. Whoever changes the value must not have used it before. Threads: any.
class Kept {
  public:
    Kept() = default;
    Kept(const Kept&) noexcept {}
    Kept& operator=(const Kept&) noexcept {
        m_kept.reset();
        return *this;
    }

    // What is kept, where it is right (bool serves(const T&)); else what make() returns, a
    // shared_ptr<const T>, which is kept from now on. All callers name the same T.
    template <typename T, typename Serves, typename Make>
    std::shared_ptr<const T> get(const Serves& serves, const Make& make) const {
        const std::lock_guard lock(m_mutex);
        auto kept = std::static_pointer_cast<const T>(m_kept);
        if (!kept || !serves(*kept)) m_kept = kept = make();
        return kept;
    }

  private:
    mutable std::mutex m_mutex;
    mutable std::shared_ptr<const void> m_kept;
};

}  // namespace pm
