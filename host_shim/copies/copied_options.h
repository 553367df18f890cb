// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>

#include "host_shim/cli/options.h"
#include "host_shim/copies/manifest.h"

namespace pm::host {

// Changes the options of a command line to what one would say that names the copies, which lie
// below tree by their places: the scene, the search paths, the colour config where none is given or
// the packed one is, the environment where the packed one is given. Nothing but the copies and what
// the command line names itself is read for the scene then.
void nameCopies(const Manifest& manifest, const std::filesystem::path& tree, Options& options);

}  // namespace pm::host
