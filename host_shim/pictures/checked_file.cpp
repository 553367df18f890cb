// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/checked_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

constexpr std::size_t kMostKept = 256 << 10;

}  // namespace

void failWriting(const std::filesystem::path& path, int error, const std::string& text) {
    const std::string reason = error != 0     ? std::string(std::strerror(error))
                               : text.empty() ? "its library gives no reason; memory may be lacking"
                                              : text;
    throw HostError(ExitCode::kFile,
                    fmt::format("{}: can't be written: {}", path.string(), reason));
}

CheckedFile::CheckedFile(const FinishedFile& finished, const std::filesystem::path& shownPath)
    : IOProxy(finished.temporaryPath().string(), Write) {
    m_file = ::fcntl(finished.descriptor(), F_DUPFD_CLOEXEC, 0);
    if (m_file < 0) failWriting(shownPath, errno, {});
    m_kept.reserve(kMostKept);  // later it would be in the middle of a library
}

CheckedFile::~CheckedFile() {
    finish();
}

int CheckedFile::finish() {
    flush();
    if (m_file >= 0 && ::close(m_file) != 0 && m_error == 0) m_error = errno;
    m_file = -1;
    m_mode = Closed;
    return m_error;
}

void CheckedFile::flush() {
    writeNow(m_kept.data(), m_kept.size(), m_keptAt);
    m_kept.clear();
}

// A writer of tiles writes some bytes at a time.
std::size_t CheckedFile::write(const void* buffer, std::size_t size) {
    const bool goesOn = m_pos == m_keptAt + static_cast<std::int64_t>(m_kept.size());
    if (!goesOn || m_kept.size() + size > kMostKept) flush();
    std::size_t written = size;
    if (size > kMostKept) {
        written = writeNow(buffer, size, m_pos);
    } else {
        if (m_kept.empty()) m_keptAt = m_pos;
        const char* bytes = static_cast<const char*>(buffer);
        m_kept.insert(m_kept.end(), bytes, bytes + size);
    }
    m_pos += static_cast<std::int64_t>(written);
    return written;
}

std::size_t CheckedFile::pwrite(const void* buffer, std::size_t size, std::int64_t offset) {
    flush();
    return writeNow(buffer, size, offset);
}

std::size_t CheckedFile::writeNow(const void* buffer, std::size_t size, std::int64_t offset) {
    const char* bytes = static_cast<const char*>(buffer);
    std::size_t done = 0;
    while (done < size) {
        const ssize_t written =
            ::pwrite(m_file, bytes + done, size - done, offset + static_cast<off_t>(done));
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) {
            int none = 0;
            m_error.compare_exchange_strong(none, written < 0 ? errno : ENOSPC);
            break;
        }
        done += static_cast<std::size_t>(written);
    }
    return done;
}

std::size_t CheckedFile::read(void* buffer, std::size_t size) {
    const std::size_t got = pread(buffer, size, m_pos);
    m_pos += static_cast<std::int64_t>(got);
    return got;
}

std::size_t CheckedFile::pread(void* buffer, std::size_t size, std::int64_t offset) {
    flush();
    const ssize_t got = ::pread(m_file, buffer, size, offset);
    return got < 0 ? 0 : static_cast<std::size_t>(got);
}

std::size_t CheckedFile::size() const {
    struct stat status {};
    const auto inFile =
        ::fstat(m_file, &status) == 0 ? static_cast<std::size_t>(status.st_size) : 0;
    return m_kept.empty() ? inFile
                          : std::max(inFile, static_cast<std::size_t>(m_keptAt) + m_kept.size());
}

}  // namespace pm::host
