// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace pm {

// Where what doesn't fit into memory is put meanwhile: bytes without a name, gone with this.
// Threads: const members from any, at once, beside a write of other bytes.
class ScratchFile {
  public:
    virtual ~ScratchFile() = default;
    // Errors of both: those of who made it, as where the disk is full.
    virtual void write(std::uint64_t offset, std::span<const std::byte> bytes) = 0;
    // Bytes that were written.
    virtual void read(std::uint64_t offset, std::span<std::byte> bytes) const = 0;
};

// Threads: any, at once.
class ScratchFolder {
  public:
    virtual ~ScratchFolder() = default;
    virtual std::unique_ptr<ScratchFile> make() = 0;
};

}  // namespace pm
