// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/file_ending.h"

#include "host_shim/values/letter_case.h"

namespace pm::host {

std::string lowerCaseExtension(const std::filesystem::path& path) {
    return lowerCase(path.extension().string());
}

}  // namespace pm::host
