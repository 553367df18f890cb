// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/pictures/host_error.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace pm::host {

// A name means finished: what is written goes to temporaryPath(), beside the final name, and takes
// that name in one step in commit(). Without commit nothing stays. An existing file of the final
// name is replaced; a symbolic link is followed.
class FinishedFile {
  public:
    // Errors: none yet; the temporary file is made by whoever writes it.
    explicit FinishedFile(const std::filesystem::path& finalPath);
    ~FinishedFile();  // removes the temporary file unless committed
    FinishedFile(const FinishedFile&) = delete;
    FinishedFile& operator=(const FinishedFile&) = delete;

    const std::filesystem::path& finalPath() const { return m_final; }
    // NAME.tmp.HOST.PID with the extension of the final name at its end, so that a writer who goes
    // by the extension finds it.
    const std::filesystem::path& temporaryPath() const { return m_temporary; }
    // Syncs the temporary file, renames it and syncs the folder. Errors: kFile.
    void commit();
    // The same under another name in the same folder.
    void commitAs(const std::filesystem::path& name);

  private:
    std::filesystem::path m_final, m_temporary;
    bool m_committed{};
};

// Text or bytes as a finished file (statistics, reports). Errors: kFile.
void writeFinishedFile(const std::filesystem::path& path, std::string_view bytes);

// NAME.EXT -> NAME.partial.EXT, where an interrupted render leaves its picture (with the attribute
// pm:complete = 0 and alpha 0 where nothing is).
std::filesystem::path partialName(const std::filesystem::path& path);

}  // namespace pm::host
