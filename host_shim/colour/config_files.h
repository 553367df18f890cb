// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <vector>

#include "host_shim/colour/colour_pipeline.h"

namespace pm::host {

// The colour config that the options (or $OCIO) choose and the files that its transforms name, as
// they are found by its search path and context: those that are there. Nothing for the config that
// is built in. Errors: as ColourPipeline; kBadInput where a file is found by an absolute path,
// since the config would not find its copy.
std::vector<std::filesystem::path> filesOfConfig(const ColourOptions& options);

}  // namespace pm::host
