// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "integrator/caches/scratch.h"

namespace pm::plugin {

// Scratch files in a folder. They have no name there, so that they end with the process, however
// that ends. Errors of the files: CallError(IO) with the folder and the system's reason. Threads:
// all functions from any, at once.
class ScratchDisk : public ScratchFolder {
  public:
    // Of an empty name usualFolder().
    explicit ScratchDisk(const std::string& folder);
    // $TMPDIR where that is set, else /tmp.
    static std::string usualFolder();

    const std::string& folder() const { return m_folder; }
    // Errors: CallError(IO) where no file can be made there.
    std::unique_ptr<ScratchFile> make() override;

    // Of all files so far; and the most that they took at once.
    std::uint64_t bytesWritten() const { return m_written.load(std::memory_order_relaxed); }
    std::uint64_t mostBytes() const { return m_most.load(std::memory_order_relaxed); }

  private:
    class File;
    void count(std::uint64_t bytes);

    const std::string m_folder;
    std::atomic<std::uint64_t> m_written{0}, m_bytes{0}, m_most{0};
};

}  // namespace pm::plugin
