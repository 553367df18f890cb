// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "plugin/include/pm_plugin.h"
#include "plugin/values/call_error.h"

namespace pm::plugin {

// The same number by the interface's name; number_asserts.cpp holds that it is.
constexpr PmrStatus toPmr(CallStatus status) noexcept {
    return static_cast<PmrStatus>(status);
}

}  // namespace pm::plugin
