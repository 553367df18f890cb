// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What lastError tells: why the last call of this thread failed; nothing when it did not.
#pragma once

#include <string>

namespace pm::plugin {

// Each thread has its own. Never fails: without memory for the text it is "out of memory".
void setLastError(const char* text) noexcept;
void clearLastError() noexcept;

// A copy, as all of these may be called in the middle of another call's callback.
std::string lastError();

}  // namespace pm::plugin
