// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>

#include "plugin/values/call_error.h"

namespace pm::plugin {

// Turns the exception being handled into a status and its text, which is empty where there is no
// memory for it. Call it inside a catch block.
CallStatus statusOfException(std::string& text) noexcept;

}  // namespace pm::plugin
