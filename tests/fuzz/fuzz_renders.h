// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// A scene of one lit triangle behind the C interface, for what renders of it write and read.
#pragma once

#include <map>
#include <string>

#include "plugin/include/pm_plugin.h"

namespace pm::fuzz {

using Settings = std::map<std::string, std::string>;

const PmrApi& api();
PmrContext context();

// Renders the triangle, 16 x 8 pixels in one pass, with these settings on top; its status.
PmrStatus renderTriangle(const Settings& settings);

// What such a render writes to the file that `setting` names; also put into the corpus that a
// fuzzer is called with (argv), so that it has something whole to begin with.
std::string makeGenuine(const std::string& setting, const Settings& settings, int argc,
                        char** argv);

}  // namespace pm::fuzz
