// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/file_ending.h"

namespace pm::host {

std::string lowerCaseExtension(const std::filesystem::path& path) {
    std::string text = path.extension().string();
    for (char& c : text) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return text;
}

}  // namespace pm::host
