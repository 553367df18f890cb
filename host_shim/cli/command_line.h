// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host_shim/cli/options.h"

namespace pm::host {

// Reads the command line; arguments are those after the program's name.
// areNamesFilled: numbers of frames are in its names of files already, and nothing in them is a
// pattern. Errors: kUsage for an unknown option, a bad value, and an option that later work will
// bring ("not available yet").
Options parseCommandLine(const std::vector<std::string>& arguments, bool areNamesFilled = false);

// One line of help for a setting of the library; empty when it has none.
using SettingHelp = std::function<std::string(const std::string& setting)>;

// The text of -h. Settings of the library are described by the library itself, when it is there.
std::string helpText(const SettingHelp& settingHelp);
// That of `pm_host merge -h`, which is the end of the other.
std::string mergeHelpText();
// The same of pm_host cache.
std::string cacheHelpText();
// And of pm_host check.
std::string checkHelpText();
// And of pm_host farm: its own options, which come to those of a render.
std::string farmHelpText();
// And of pm_host watch: its own options, which come to those of merge.
std::string watchHelpText();
// And of pm_host pack.
std::string packHelpText();

}  // namespace pm::host
