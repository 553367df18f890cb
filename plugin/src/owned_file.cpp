// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/src/owned_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <utility>

#include "plugin/src/call_error.h"

namespace pm::plugin {

OwnedFile::OwnedFile(std::string name, int flags) : m_name(std::move(name)) {
    m_file = ::open(m_name.c_str(), flags | O_CLOEXEC, 0666);
    if (m_file < 0) fail("can't be opened");
}

OwnedFile::~OwnedFile() {
    if (m_file >= 0) ::close(m_file);
}

OwnedFile::OwnedFile(OwnedFile&& other) noexcept
    : m_file(std::exchange(other.m_file, -1)), m_name(std::move(other.m_name)) {}

OwnedFile& OwnedFile::operator=(OwnedFile&& other) noexcept {
    std::swap(m_file, other.m_file);
    std::swap(m_name, other.m_name);
    return *this;
}

void OwnedFile::fail(const char* what) const {
    const int error = errno;
    throw CallError(PMR_ERROR_IO, fmt::format("{}: {}: {}", m_name, what,
                                              std::generic_category().message(error)));
}

void OwnedFile::rename(const std::string& to) {
    if (std::rename(m_name.c_str(), to.c_str()) != 0) fail("can't be renamed");
    m_name = to;
}

std::uint64_t OwnedFile::size() const {
    struct stat found {};
    if (::fstat(m_file, &found) != 0) fail("can't be measured");
    return static_cast<std::uint64_t>(found.st_size);
}

void OwnedFile::truncate(std::uint64_t size) const {
    if (::ftruncate(m_file, static_cast<off_t>(size)) != 0) fail("can't be cut");
}

void OwnedFile::writeAt(std::uint64_t offset, std::span<const std::byte> bytes) const {
    while (!bytes.empty()) {
        const ssize_t written =
            ::pwrite(m_file, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (written < 0 && errno == EINTR) continue;
        if (written == 0) errno = ENOSPC;
        if (written <= 0) fail("can't be written");
        bytes = bytes.subspan(static_cast<std::size_t>(written));
        offset += static_cast<std::uint64_t>(written);
    }
}

bool OwnedFile::readAt(std::uint64_t offset, std::span<std::byte> bytes) const {
    while (!bytes.empty()) {
        const ssize_t got = ::pread(m_file, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) fail("can't be read");
        if (got == 0) return false;
        bytes = bytes.subspan(static_cast<std::size_t>(got));
        offset += static_cast<std::uint64_t>(got);
    }
    return true;
}

void OwnedFile::sync() const {
    if (::fdatasync(m_file) != 0) fail("can't be written");
}

bool OwnedFile::lock() const {
    if (::flock(m_file, LOCK_EX | LOCK_NB) == 0) return true;
    if (errno == EWOULDBLOCK) return false;
    fail("can't be locked");
}

void OwnedFile::unlock() const noexcept {
    ::flock(m_file, LOCK_UN);
}

bool OwnedFile::isAtItsName() const {
    struct stat own {
    }, named{};
    return ::fstat(m_file, &own) == 0 && ::stat(m_name.c_str(), &named) == 0 &&
           own.st_dev == named.st_dev && own.st_ino == named.st_ino;
}

void syncFolderOf(const std::string& file) {
    std::filesystem::path folder = std::filesystem::path(file).parent_path();
    if (folder.empty()) folder = ".";
    const int open = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (open < 0) return;
    ::fsync(open);
    ::close(open);
}

std::string temporaryNameOf(const std::string& file) {
    std::array<char, 256> host{};
    std::string name = ::gethostname(host.data(), host.size() - 1) == 0 ? host.data() : "host";
    std::replace(name.begin(), name.end(), '/', '_');
    return fmt::format("{}.tmp.{}.{}", file, name, ::getpid());
}

}  // namespace pm::plugin
