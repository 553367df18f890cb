// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>

namespace pm::host {

// Where folders and files go that nobody keeps: $TMPDIR, else /tmp. Absolute.
std::filesystem::path temporaryPlace();

// A folder of our own there, made when it is first asked for and removed with this.
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
