// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "plugin/storage/owned_file.h"

namespace pm::plugin {

// A file that is written as OwnedFile::temporaryFor(its name) and removed unless it is committed.
// Errors of all members: CallError(IO).
class TemporaryFile {
  public:
    explicit TemporaryFile(std::string finalName);
    ~TemporaryFile();
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    const std::string& finalName() const { return m_final; }
    // Shared, so that a sync that is on its way keeps it open.
    const std::shared_ptr<OwnedFile>& file() const { return m_file; }
    void append(std::span<const std::byte> bytes);
    void sync() const { m_file->sync(); }
    // Removes it now.
    void remove() noexcept;
    // Gives it its name; synced before, it is whole.
    void rename();
    // And syncs the folder.
    void commit();
    // The same where nothing has the name yet; else false, and this stays as it was.
    bool commitNew();

  private:
    const std::string m_final;
    std::shared_ptr<OwnedFile> m_file;
    std::uint64_t m_end = 0;
    bool m_isThere = true;  // under the temporary name
};

}  // namespace pm::plugin
