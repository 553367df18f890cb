// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <functional>

namespace pm::host {

// Called now and then by what takes long; throws where it is to be given up. May be empty.
using GoOn = std::function<void()>;

}  // namespace pm::host
