// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace pm {

// What kind of thing went wrong; the plugin maps each to the status of the same name in
// pm_plugin.h.
enum class Status : std::int32_t {
    kInvalidArgument,  // a value outside what is allowed
    kInvalidScene,     // the scene can't be rendered as it is
    kUnsupported,      // a kind that this version does not render
    kOutOfMemory,
    kCancelled,
    kIo,        // a file can't be read
    kInternal,  // a fault of ours
};

// The one exception of the project: thrown while settings are read and scenes are built, never per
// ray. The text says what was given, what is allowed, and where.
class Error : public std::runtime_error {
  public:
    Error(Status status, const std::string& text) : std::runtime_error(text), m_status(status) {}
    Status status() const { return m_status; }

  private:
    Status m_status;
};

}  // namespace pm
