// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/finished_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace pm::host {
namespace {

std::string hostName() {
    std::array<char, 256> text{};
    if (::gethostname(text.data(), text.size() - 1) != 0) return "host";
    std::string name(text.data());
    for (char& c : name) {
        if (c == '/') c = '_';
    }
    return name;
}

// Also where the link points to nothing yet.
std::filesystem::path followLink(std::filesystem::path path) {
    constexpr int kMostLinks = 40;  // as the kernel has it; a loop fails when it is opened
    std::error_code failed;
    for (int i = 0; i < kMostLinks && std::filesystem::is_symlink(path, failed); ++i) {
        const auto target = std::filesystem::read_symlink(path, failed);
        if (failed) break;
        path = target.is_absolute() ? target : path.parent_path() / target;
    }
    return path;
}

// What follows a name cut so that both fit into one; never within a character of UTF-8.
std::string cutTo(std::string name, std::size_t most) {
    if (name.size() <= most) return name;
    while (most > 0 && (static_cast<unsigned char>(name[most]) & 0xc0u) == 0x80) --most;
    name.resize(most);
    return name;
}

constexpr std::size_t kLongestName = 255;  // bytes, of Linux's file systems

std::filesystem::path withEnding(const std::filesystem::path& path, const std::string& name,
                                 const std::string& ending) {
    const std::size_t most = kLongestName - std::min(kLongestName, ending.size());
    return path.parent_path() / (cutTo(name, most) + ending);
}

// Returns 0 or an errno.
int syncPath(const std::filesystem::path& path, int flags) {
    const int file = ::open(path.c_str(), flags | O_CLOEXEC);
    if (file < 0) return errno;
    const int failed = ::fsync(file) == 0 ? 0 : errno;
    ::close(file);
    return failed;
}

int writeAll(int file, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(file, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return written < 0 ? errno : ENOSPC;
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return 0;
}

// By what each picture of pm's says of itself, near its beginning or, in a TIFF, its end.
bool isOwnPicture(const std::filesystem::path& path) {
    constexpr off_t kNear = 1 << 16;
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (file < 0) return false;
    struct stat status {};
    std::string text(2 * kNear, '\0');
    if (::fstat(file, &status) == 0 && S_ISREG(status.st_mode)) {
        const ssize_t head = ::pread(file, text.data(), kNear, 0);
        const ssize_t tail =
            ::pread(file, text.data() + kNear, kNear, std::max<off_t>(0, status.st_size - kNear));
        static_cast<void>(head + tail);
    }
    ::close(file);
    return text.find("pm:complete") != text.npos || text.find("pm:exposure") != text.npos;
}

[[noreturn]] void fail(const std::filesystem::path& path, int error) {
    throw HostError(ExitCode::kFile,
                    fmt::format("{}: can't be written: {}", path.string(), std::strerror(error)));
}

}  // namespace

FinishedFile::FinishedFile(const std::filesystem::path& finalPath)
    : m_final(followLink(finalPath)) {
    constexpr int kTries = 1000;  // of names that somebody has
    std::error_code ignored;
    const int mode = std::filesystem::exists(m_final, ignored) ? 0600 : 0666;  // until it is whole
    for (int i = 0; i < kTries && m_file < 0; ++i) {
        const std::string ending =
            fmt::format(".tmp.{}.{}{}{}", hostName(), ::getpid(),
                        i == 0 ? "" : fmt::format(".{}", i), m_final.extension().string());
        m_temporary = withEnding(m_final, m_final.filename().string(), ending);
        m_file =
            ::open(m_temporary.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
        if (m_file < 0 && errno != EEXIST) break;
    }
    if (m_file < 0) {
        throw HostError(ExitCode::kFile, fmt::format("{}: no file can be made in its folder: {}",
                                                     m_final.string(), std::strerror(errno)));
    }
}

FinishedFile::~FinishedFile() {
    ::close(m_file);
    std::error_code ignored;
    if (!m_committed) std::filesystem::remove(m_temporary, ignored);
}

void FinishedFile::commit() {
    commitAs(m_final);
}

void FinishedFile::commitAs(const std::filesystem::path& name) {
    takeOver(name);
    if (const int error = syncPath(m_temporary, O_RDWR)) fail(name, error);
    if (::rename(m_temporary.c_str(), name.c_str()) != 0) fail(name, errno);
    m_committed = true;
    // Some network file systems can't sync a folder; the file itself is safe by then.
    syncPath(name.has_parent_path() ? name.parent_path() : ".", O_RDONLY | O_DIRECTORY);
}

// A file is replaced by one that may be read and written by the same people.
void FinishedFile::takeOver(const std::filesystem::path& name) const {
    struct stat replaced {};
    if (::stat(name.c_str(), &replaced) != 0 && ::stat(m_final.c_str(), &replaced) != 0) return;
    // To others it can be given by root only; to another of the user's groups by anyone.
    const bool isGiven = ::fchown(m_file, replaced.st_uid, replaced.st_gid) == 0 ||
                         ::fchown(m_file, static_cast<uid_t>(-1), replaced.st_gid) == 0;
    static_cast<void>(isGiven);
    ::fchmod(m_file, replaced.st_mode & 0777u);
}

void FinishedFile::write(std::string_view bytes) {
    if (const int error = writeAll(m_file, bytes)) fail(m_final, error);
}

void writeFinishedFile(const std::filesystem::path& path, std::string_view bytes) {
    FinishedFile finished(path);
    finished.write(bytes);
    finished.commit();
}

std::filesystem::path partialName(const std::filesystem::path& path) {
    for (int i = 1;; ++i) {
        const std::string number = i == 1 ? "" : fmt::format(".{}", i);
        const auto name =
            withEnding(path, path.stem().string(), ".partial" + number + path.extension().string());
        std::error_code ignored;
        if (!std::filesystem::exists(std::filesystem::symlink_status(name, ignored)) ||
            isOwnPicture(name))
            return name;
    }
}

}  // namespace pm::host
