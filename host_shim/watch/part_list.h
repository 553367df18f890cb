// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host_shim/cli/options.h"

namespace pm::host {

// A part that is there or awaited.
struct ListedPart {
    std::filesystem::path file;
    std::string what;     // buckets A:B, where a plan says so
    std::string machine;  // that made it or makes it, where a job tells
    bool isUnderWay{};    // by a job's word
    double progress{};    // of what is under way, in [0, 1]
};

// The parts of a command line of pm_host watch, as they are at this moment: those that it names, in
// its folders all *.pmpart by name, or those of a job's plan (none before there is a plan). Errors:
// HostError kUsage where a job has several frames and none is chosen, or has not the one that is;
// kFile, kBadInput of reading the plan.
std::vector<ListedPart> listParts(const Options& options);

}  // namespace pm::host
