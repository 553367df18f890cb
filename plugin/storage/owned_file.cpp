// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/storage/owned_file.h"

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

#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

std::string hostName() {
    std::array<char, 256> host{};
    std::string name = ::gethostname(host.data(), host.size() - 1) == 0 ? host.data() : "host";
    std::replace(name.begin(), name.end(), '/', '_');
    return name;
}

}  // namespace

OwnedFile::OwnedFile(std::string name, int flags) : m_name(std::move(name)) {
    // A pipe would be waited for until somebody comes to its other end.
    open(flags | O_NONBLOCK | O_NOCTTY);
    if (m_file < 0) fail("can't be opened");
    struct stat found {};
    if (::fstat(m_file, &found) == 0 && S_ISREG(found.st_mode)) return;
    ::close(std::exchange(m_file, -1));
    throw CallError(CallStatus::kIo, m_name + ": can't be opened: it is no file");
}

OwnedFile OwnedFile::temporaryFor(const std::string& file) {
    constexpr int kTries = 1000;           // of names that somebody has
    constexpr std::size_t kLongest = 255;  // bytes of a name, of Linux's file systems
    const std::filesystem::path path(file);
    OwnedFile made;
    for (int i = 0; i < kTries && made.m_file < 0; ++i) {
        const std::string ending = fmt::format(".tmp.{}.{}{}", hostName(), ::getpid(),
                                               i == 0 ? "" : fmt::format(".{}", i));
        std::string name = path.filename().string();
        std::size_t most = kLongest - std::min(kLongest, ending.size());
        if (name.size() > most) {
            // Never within a character of UTF-8.
            while (most > 0 && (static_cast<unsigned char>(name[most]) & 0xc0u) == 0x80) --most;
            name.resize(most);
        }
        made.m_name = (path.parent_path() / (name + ending)).string();
        made.open(O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW);
        if (made.m_file < 0 && errno != EEXIST) break;
    }
    if (made.m_file < 0) made.fail("can't be opened");
    return made;
}

void OwnedFile::open(int flags) {
    m_file = ::open(m_name.c_str(), flags | O_CLOEXEC, 0666);
    if (m_file < 0 || m_file > STDERR_FILENO) return;
    const int low = std::exchange(m_file, ::fcntl(m_file, F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
    const int error = errno;
    ::close(low);
    errno = error;
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
    throw CallError(CallStatus::kIo, fmt::format("{}: {}: {}", m_name, what,
                                                 std::generic_category().message(error)));
}

void OwnedFile::rename(const std::string& to) {
    struct stat replaced {};
    if (::stat(to.c_str(), &replaced) == 0) {
        // To others it can be given by root only; to another of the user's groups by anyone.
        const bool isGiven = ::fchown(m_file, replaced.st_uid, replaced.st_gid) == 0 ||
                             ::fchown(m_file, static_cast<uid_t>(-1), replaced.st_gid) == 0;
        static_cast<void>(isGiven);
        ::fchmod(m_file, replaced.st_mode & 0777u);
    }
    if (std::rename(m_name.c_str(), to.c_str()) != 0) fail("can't be renamed");
    m_name = to;
}

bool OwnedFile::renameToNew(const std::string& to) {
    const auto tried = [&](unsigned flags) {
        return ::renameat2(AT_FDCWD, m_name.c_str(), AT_FDCWD, to.c_str(), flags) == 0;
    };
    if (!tried(RENAME_NOREPLACE)) {
        if (errno == EEXIST) return false;
        // A file system that can't tell in one step, such as one of a network.
        struct stat there {};
        if ((errno != EINVAL && errno != ENOSYS) || ::lstat(to.c_str(), &there) == 0 || !tried(0))
            fail("can't be renamed");
    }
    m_name = to;
    return true;
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

}  // namespace pm::plugin
