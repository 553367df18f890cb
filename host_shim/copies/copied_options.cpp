// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/copies/copied_options.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

bool isMeant(const std::optional<PackedOption>& packed, const std::string& text) {
    return packed && (text.empty() || text == packed->text);
}

}  // namespace

void nameCopies(const Manifest& manifest, const fs::path& tree, Options& options) {
    options.scene = tree / manifest.scene;
    SceneFileRules& rules = options.reading.files;
    rules.isTrusted = false;
    rules.moved = {manifest.base, tree};
    rules.alsoAllowed.push_back(tree);
    std::vector<fs::path> paths;
    for (const std::string& place : manifest.searchPaths) paths.push_back(tree / place);
    rules.searchPaths.insert(rules.searchPaths.begin(), paths.begin(), paths.end());
    if (isMeant(manifest.ocio, options.colour.ocioFile))
        options.colour.ocioFile = (tree / manifest.ocio->place).string();
    fs::path& environment = options.sky.environment;
    if (!environment.empty() && isMeant(manifest.environment, environment.string()))
        environment = tree / manifest.environment->place;
}

}  // namespace pm::host
