// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/src/temporary_file.h"

#include <filesystem>
#include <system_error>
#include <utility>

namespace pm::plugin {

TemporaryFile::TemporaryFile(std::string finalName)
    : m_final(std::move(finalName)),
      m_file(std::make_shared<OwnedFile>(OwnedFile::temporaryFor(m_final))) {}

TemporaryFile::~TemporaryFile() {
    remove();
}

void TemporaryFile::remove() noexcept {
    std::error_code ignored;
    if (std::exchange(m_isThere, false)) std::filesystem::remove(m_file->name(), ignored);
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

}  // namespace pm::plugin
