// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

#include "plugin/include/pm_plugin.h"

namespace pm::plugin {

// What an entry point throws to end a call with a status; the wrapper in entry.h turns it into the
// call's result and the context's last error. The text says what was given and what is allowed.
class CallError : public std::runtime_error {
  public:
    CallError(PmrStatus status, const std::string& text)
        : std::runtime_error(text), m_status(status) {}
    PmrStatus status() const { return m_status; }

  private:
    PmrStatus m_status;
};

// The most common one: a value outside of what is allowed.
inline CallError argumentError(const std::string& text) {
    return {PMR_ERROR_ARGUMENT, text};
}

inline void checkIndex(std::size_t index, std::size_t count) {
    if (index >= count)
        throw argumentError("index is " + std::to_string(index) + "; there are " +
                            std::to_string(count));
}

}  // namespace pm::plugin
