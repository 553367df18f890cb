// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/cli/options.h"
#include "host_shim/ingest/scene_data.h"

#include <span>
#include <string>

namespace pm::host {

// options.materials, and the folder of the colour config that they name among what may be read.
MaterialRules materialRules(const Options& options);

// Lines of --explain: which dialect was taken for each library, and why. Empty without libraries.
std::string explainMaterials(std::span<const MaterialFile> libraries);

}  // namespace pm::host
