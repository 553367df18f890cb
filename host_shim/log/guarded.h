// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <functional>
#include <string>

#include "host_shim/log/log.h"

namespace pm::host {

// Runs work and turns whatever it throws into one line in the log and an exit code; the text is
// also handed to onError when that is given.
int guarded(Log& log, const std::function<int()>& work, std::string* errorText = nullptr);

}  // namespace pm::host
