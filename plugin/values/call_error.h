// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace pm::plugin {

// How a call ends. The numbers are those of the statuses of the same names in pm_plugin.h, which
// plugin/api holds to.
enum class CallStatus : std::int32_t {
    kOk = 0,
    kInternal = -1,
    kArgument = -2,
    kHandle = -3,
    kState = -4,
    kScene = -5,
    kUnsupported = -6,
    kMemory = -7,
    kIo = -8,
    kCancelled = -9,
    kInCallback = -10,
    kTimeout = -11,
    kAbi = -12,
    kName = -13,
    kFile = -14,
    kMismatch = -15,
};

// What ends a call with a status; plugin/api turns it into the call's result and the last error of
// its thread. The text says what was given and what is allowed.
class CallError : public std::runtime_error {
  public:
    CallError(CallStatus status, const std::string& text)
        : std::runtime_error(text), m_status(status) {}
    CallStatus status() const { return m_status; }

  private:
    CallStatus m_status;
};

// The most common one: a value outside of what is allowed.
inline CallError argumentError(const std::string& text) {
    return {CallStatus::kArgument, text};
}

inline void checkIndex(std::size_t index, std::size_t count) {
    if (index >= count)
        throw argumentError("index is " + std::to_string(index) + "; there are " +
                            std::to_string(count));
}

}  // namespace pm::plugin
