// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "host_shim/pictures/picture.h"

namespace pm::host {

// What a render is made of: "object NAME", "material NAME", "light NAME", "texture FILE", "camera",
// "config", each with a hash. Files are relative to the suite's folder.
using SceneInputs = std::map<std::string, std::string>;

// What a render tells beside its picture.
struct RenderFacts {
    SceneInputs inputs;
    std::vector<std::string> warnings;  // as they were shown, each once
    std::string errorWords;             // what its error looks like; empty where it isn't known
};

// statistics, log, picture: of a render by this program; folder: the suite's. Errors: kFile,
// kBadInput.
RenderFacts readFacts(const std::filesystem::path& statistics, const std::filesystem::path& log,
                      const Picture& picture, const std::filesystem::path& folder);

// "material wall, light sun; new: object ball; gone: texture wood.png"; empty where nothing
// differs.
std::string differences(const SceneInputs& before, const SceneInputs& now);

// Those that are not among the ones before, whatever numbers are in them.
std::vector<std::string> newWarnings(const std::vector<std::string>& before,
                                     const std::vector<std::string>& now);

}  // namespace pm::host
