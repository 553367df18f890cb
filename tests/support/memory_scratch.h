// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <atomic>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

#include "integrator/caches/scratch.h"

namespace pm::test {

// Scratch files in memory that count the bytes there are.
class MemoryScratch : public ScratchFolder {
  public:
    std::unique_ptr<ScratchFile> make() override { return std::make_unique<File>(*this); }

    std::atomic<std::uint64_t> bytes{0}, most{0}, written{0};
    std::atomic<std::uint32_t> files{0};

  private:
    class File : public ScratchFile {
      public:
        explicit File(MemoryScratch& folder) : m_folder(folder) { ++m_folder.files; }
        ~File() override {
            --m_folder.files;
            m_folder.bytes -= m_own;
        }
        // Each place is written once.
        void write(std::uint64_t offset, std::span<const std::byte> bytes) override {
            m_bytes.resize(std::max<std::size_t>(m_bytes.size(), offset + bytes.size()));
            std::memcpy(m_bytes.data() + offset, bytes.data(), bytes.size());
            m_own += bytes.size();
            m_folder.written += bytes.size();
            m_folder.bytes += bytes.size();
            m_folder.most = std::max(m_folder.most.load(), m_folder.bytes.load());
        }
        void read(std::uint64_t offset, std::span<std::byte> bytes) const override {
            std::memcpy(bytes.data(), m_bytes.data() + offset, bytes.size());
        }

      private:
        MemoryScratch& m_folder;
        std::vector<std::byte> m_bytes;
        std::uint64_t m_own = 0;
    };
};

}  // namespace pm::test
