// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/storage/temporary_file.h"

#include <unistd.h>

#include <utility>

namespace pm::plugin {

TemporaryFile::TemporaryFile(std::string finalName)
    : m_final(std::move(finalName)),
      m_file(std::make_shared<OwnedFile>(OwnedFile::temporaryFor(m_final))) {}

TemporaryFile::~TemporaryFile() {
    remove();
}

void TemporaryFile::remove() noexcept {
    // Not through a path of the library's, which takes memory.
    if (std::exchange(m_isThere, false)) ::unlink(m_file->name().c_str());
}

void TemporaryFile::append(std::span<const std::byte> bytes) {
    m_file->writeAt(m_end, bytes);
    m_end += bytes.size();
}

void TemporaryFile::rename() {
    m_file->rename(m_final);
    m_isThere = false;
}

void TemporaryFile::commit() {
    rename();
    syncFolderOf(m_final);
}

bool TemporaryFile::commitNew() {
    if (!m_file->renameToNew(m_final)) return false;
    m_isThere = false;
    syncFolderOf(m_final);
    return true;
}

}  // namespace pm::plugin
