// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host_shim/cli/options.h"
#include "host_shim/copies/manifest.h"

namespace pm::host {

// The places of the files that a scene reads, in the order in which they are listed. options name
// its copies below tree (nameCopies). Files that are not there are left out.
std::vector<std::string> placesRead(const Options& options, const std::filesystem::path& tree);

// Reads the scene from its copies, as one who fetched them does, and compares which files that
// leads to. folder: has the contents of the manifest; a tree of links is made there and removed
// again. options: of the scene itself; expected: places of the files that it read, in their order.
// Errors: kBadInput where another file would be read, saying which; kFile; those of reading.
void checkReadsTheSame(const Manifest& manifest, const std::filesystem::path& folder,
                       const Options& options, const std::vector<std::string>& expected);

}  // namespace pm::host
