// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/finished_file.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>
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

std::filesystem::path temporaryName(const std::filesystem::path& path) {
    return path.string() +
           fmt::format(".tmp.{}.{}{}", hostName(), ::getpid(), path.extension().string());
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

[[noreturn]] void fail(const std::filesystem::path& path, int error) {
    throw HostError(ExitCode::kFile,
                    fmt::format("{}: can't be written: {}", path.string(), std::strerror(error)));
}

}  // namespace

FinishedFile::FinishedFile(const std::filesystem::path& finalPath)
    : m_final(followLink(finalPath)), m_temporary(temporaryName(m_final)) {}

FinishedFile::~FinishedFile() {
    std::error_code ignored;
    if (!m_committed) std::filesystem::remove(m_temporary, ignored);
}

void FinishedFile::commit() {
    commitAs(m_final);
}

void FinishedFile::commitAs(const std::filesystem::path& name) {
    if (const int error = syncPath(m_temporary, O_RDWR)) fail(name, error);
    if (::rename(m_temporary.c_str(), name.c_str()) != 0) fail(name, errno);
    m_committed = true;
    // Some network file systems can't sync a folder; the file itself is safe by then.
    syncPath(name.has_parent_path() ? name.parent_path() : ".", O_RDONLY | O_DIRECTORY);
}

void writeFinishedFile(const std::filesystem::path& path, std::string_view bytes) {
    FinishedFile finished(path);
    const int file = ::open(finished.temporaryPath().c_str(),
                            O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (file < 0) fail(path, errno);
    int error = writeAll(file, bytes);
    if (::close(file) != 0 && error == 0) error = errno;
    if (error != 0) fail(path, error);
    finished.commit();
}

std::filesystem::path partialName(const std::filesystem::path& path) {
    std::filesystem::path name = path;
    name.replace_extension();
    name += ".partial" + path.extension().string();
    return name;
}

}  // namespace pm::host
