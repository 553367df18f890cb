// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "host_shim/values/host_error.h"

namespace pm::host {

// A name means finished: what is written goes to temporaryPath(), beside the final name, and takes
// that name in one step in commit(). Without commit nothing stays. An existing file of the final
// name is replaced by one of the same mode, and of the same owner and group where this user may
// give it to them; other hard links keep the old one. A symbolic link is followed: what it leads to
// is replaced, and it stays.
class FinishedFile {
  public:
    // Makes the temporary file, under a name that nothing had. Errors: kFile.
    explicit FinishedFile(const std::filesystem::path& finalPath);
    ~FinishedFile();  // removes the temporary file unless committed
    FinishedFile(const FinishedFile&) = delete;
    FinishedFile& operator=(const FinishedFile&) = delete;

    const std::filesystem::path& finalPath() const { return m_final; }
    // NAME.tmp.HOST.PID, or NAME.tmp.HOST.PID.N where that was there, with the extension of the
    // final name at its end, so that a writer who goes by the extension finds it; NAME cut where
    // that is too long.
    const std::filesystem::path& temporaryPath() const { return m_temporary; }
    // The temporary file, open for reading and writing.
    int descriptor() const { return m_file; }
    // Adds to it. Errors: kFile.
    void write(std::string_view bytes);
    // Syncs the temporary file, renames it and syncs the folder. Errors: kFile.
    void commit();
    // The same under another name in the same folder.
    void commitAs(const std::filesystem::path& name);

  private:
    void takeOver(const std::filesystem::path& name) const;

    std::filesystem::path m_final, m_temporary;
    int m_file{-1};
    bool m_committed{};
};

// Text or bytes as a finished file (statistics, reports). Errors: kFile.
void writeFinishedFile(const std::filesystem::path& path, std::string_view bytes);

// NAME.EXT -> NAME.partial.EXT, where an interrupted render leaves its picture (with the attribute
// pm:complete = 0 and alpha 0 where nothing is); NAME cut where that is too long. Where a file is
// there that is no picture of pm's, NAME.partial.2.EXT and so on.
std::filesystem::path partialName(const std::filesystem::path& path);

}  // namespace pm::host
