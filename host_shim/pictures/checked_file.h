// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <OpenImageIO/filesystem.h>

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "host_shim/pictures/finished_file.h"

namespace pm::host {

// Ends the writing of path. error: an errno, or 0 where the system told none; text: what the
// library said, which is nothing where its memory ran out. Throws HostError kFile.
[[noreturn]] void failWriting(const std::filesystem::path& path, int error,
                              const std::string& text);

// The file that a picture writer of OpenImageIO writes into, with every failure remembered: the
// writers themselves return true for a JPEG, a PNG or the end of an EXR on a full disk. For one
// thread.
class CheckedFile final : public OIIO::Filesystem::IOProxy {
  public:
    // finished: new, and outlives this. Errors: HostError kFile, naming shownPath.
    CheckedFile(const FinishedFile& finished, const std::filesystem::path& shownPath);
    ~CheckedFile() override;
    CheckedFile(const CheckedFile&) = delete;
    CheckedFile& operator=(const CheckedFile&) = delete;

    // 0, or the errno of the first failure; of what was written last it may come with the next
    // call.
    int firstError() const { return m_error; }
    // Closes and returns firstError().
    int finish();

    const char* proxytype() const override { return "pm_checked_file"; }
    std::size_t write(const void* buffer, std::size_t size) override;
    std::size_t pwrite(const void* buffer, std::size_t size, std::int64_t offset) override;
    std::size_t read(void* buffer, std::size_t size) override;
    std::size_t pread(void* buffer, std::size_t size, std::int64_t offset) override;
    std::size_t size() const override;

  private:
    void flush();
    std::size_t writeNow(const void* buffer, std::size_t size, std::int64_t offset);

    int m_file{-1};
    std::vector<char> m_kept;  // what was written last, not yet in the file
    std::int64_t m_keptAt{};   // where it belongs
    std::atomic<int> m_error{0};
};

}  // namespace pm::host
