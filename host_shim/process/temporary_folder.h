// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>

namespace pm::host {

// A folder of our own for baked textures, made when it is first asked for and removed with this.
class TemporaryFolder {
  public:
    TemporaryFolder() = default;
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    // Errors: kFile.
    const std::filesystem::path& path();

  private:
    std::filesystem::path m_path;
};

}  // namespace pm::host
