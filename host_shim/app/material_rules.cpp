// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/material_rules.h"

#include <fmt/format.h>

#include <cstdlib>

namespace pm::host {

namespace fs = std::filesystem;

MaterialRules materialRules(const Options& options) {
    MaterialRules rules = options.materials;
    std::string config = options.colour.ocioFile;
    if (const char* const variable = std::getenv("OCIO"); config.empty() && variable != nullptr)
        config = variable;
    std::error_code ignored;
    if (!config.empty() && fs::is_regular_file(config, ignored))
        rules.files.alsoAllowed.push_back(fs::path(config).parent_path());
    return rules;
}

std::string explainMaterials(std::span<const MaterialFile> libraries) {
    std::string text;
    for (const MaterialFile& library : libraries)
        text += fmt::format("materials: {} is read as {}, since {}\n", library.file,
                            library.dialect, library.reason);
    return text;
}

}  // namespace pm::host
