// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>

#include "plugin/values/json.h"

namespace pm::plugin {

// "0.1.0 (embree 3.13.5, OpenImageIO 2.4.7, TBB 2021.8)".
const std::string& versionText();

// The same by name.
Json versionsJson();

// What the linker marked this library with, hexadecimal digits: two builds have two of them. Empty
// where the linker makes none.
const std::string& buildId();

}  // namespace pm::plugin
