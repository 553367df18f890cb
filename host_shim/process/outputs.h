// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pm::host {

// Checks all that will be written, before the first ray: format, folder, permission, and that no
// two are the same file. With makeFolders missing folders are made. Errors: kUsage for a format or
// a duplicate, kFile for a folder or permission.
void checkOutputs(const std::vector<std::filesystem::path>& pictures,
                  const std::vector<std::filesystem::path>& others, bool makeFolders);

// Errors: kUsage when an output is one of the inputs.
void checkNotInputs(const std::vector<std::filesystem::path>& outputs,
                    const std::vector<std::filesystem::path>& inputs);

}  // namespace pm::host
