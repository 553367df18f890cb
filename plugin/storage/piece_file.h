// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The file format that checkpoints, parts and photon maps share: eight bytes of magic, then
// records, the first of them a head. Each record has its length and a checksum (XXH3) of its own,
// so that of a file that was cut short or damaged it is known how far it holds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "integrator/values/rect.h"
#include "plugin/storage/owned_file.h"

namespace pm::plugin {

enum class PieceRecord : std::uint32_t {
    kHead = 1,     // text, see PieceHead
    kSums = 2,     // a rectangle, then its pixels as FrameStoreBytes gives them
    kPass = 3,     // pass and rectangle, then what the pass gave: the pixels' floats, their weights
    kEnd = 4,      // of a part or photon map: the number of records before it; nothing may follow
    kPhotons = 5,  // of a photon map: see TracedHead
};

// Appends a record to `bytes`.
void appendRecord(PieceRecord kind, std::span<const std::byte> payload,
                  std::vector<std::byte>& bytes);

// The magic and a head with this text.
std::vector<std::byte> beginningOfPiece(const std::string& head);

// No head that is written here is nearly as long.
inline constexpr std::uint64_t kLongestHead = std::uint64_t{1} << 20;

// Reads a piece from its beginning. Errors: CallError(IO) when it can't be read; broken pieces are
// no error but a state.
class PieceReader {
  public:
    // The file must outlive this.
    explicit PieceReader(const OwnedFile& file);

    // Whether it begins as pieces do. An empty file doesn't.
    bool isPiece() const { return m_isPiece; }
    // Reads the next record into kind() and payload(); of one with more bytes than these only the
    // checksum is looked at, and payload() is empty, as a file may claim any size, and have it
    // where it has holes. False at the end and where the file is broken.
    bool next(std::uint64_t mostBytes = kLongestHead);
    PieceRecord kind() const { return m_kind; }
    std::span<const std::byte> payload() const { return m_payload; }
    // Up to here all records are whole; where that is not the file's size, what follows is not.
    std::uint64_t wholeBytes() const { return m_whole; }
    bool isBroken() const { return m_whole != m_size; }
    std::uint64_t brokenBytes() const { return m_size - m_whole; }

  private:
    const OwnedFile& m_file;
    std::uint64_t m_size = 0, m_whole = 0;
    bool m_isPiece = false;
    PieceRecord m_kind = PieceRecord::kHead;
    std::vector<std::byte> m_payload;
};

// Records that are too large to be in memory twice.

inline constexpr std::uint64_t kFirstRecordAt = 8;  // behind the magic
bool isPiece(const OwnedFile& file);

// Where a record's payload stands.
struct RecordPlace {
    PieceRecord kind = PieceRecord::kHead;
    std::uint64_t payloadAt = 0, payloadBytes = 0;
    std::uint64_t checksum = 0;

    std::uint64_t end() const { return payloadAt + payloadBytes; }
};
// The record whose head stands at `at`; nothing where it does not fit into the file.
std::optional<RecordPlace> findRecord(const OwnedFile& file, std::uint64_t at,
                                      std::uint64_t fileSize);

// Called now and then, while much is read or written; may throw to end that.
using BetweenChunks = std::function<void()>;
// Writes a record whose payload is these parts one behind the other.
RecordPlace writeRecord(const OwnedFile& file, std::uint64_t at, PieceRecord kind,
                        std::span<const std::span<const std::byte>> payload,
                        const BetweenChunks& between);
// Fills the parts, together as long as the payload. False where they don't have its checksum.
bool readRecord(const OwnedFile& file, const RecordPlace& place,
                std::span<const std::span<std::byte>> payload, const BetweenChunks& between);
// Whether a record has its checksum.
bool isWhole(const OwnedFile& file, const RecordPlace& place, const BetweenChunks& between);

// The beginning of a kSums or kPass payload; passes of a kSums record are 0.
inline constexpr std::uint64_t kAreaBytes = 20;
struct PieceArea {
    std::uint32_t pass = 0;
    Rect rect;
};
void appendArea(const PieceArea& area, std::vector<std::byte>& payload);
// Takes the area off the beginning of a payload. Errors: CallError(FILE) where there is none.
PieceArea takeArea(std::span<const std::byte>& payload);

}  // namespace pm::plugin
