// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host_shim/check/reference.h"
#include "host_shim/check/scene_check.h"

namespace pm::host {

struct RenderedFiles {
    std::filesystem::path exr, png;  // png may be empty
};

// The numbers of a reference from renders that differ in the seed alone, the one that is kept
// first. before: the .json that there may be, whose reasons are kept. Errors: kBadInput where a
// value is not finite or `before` is no reference.
Reference makeReference(const std::vector<RenderedFiles>& renders,
                        const std::filesystem::path& before, const std::string& because);

// Errors: kFile.
void storeReference(const RenderedFiles& kept, const Reference& reference,
                    const ReferenceFiles& files);

}  // namespace pm::host
