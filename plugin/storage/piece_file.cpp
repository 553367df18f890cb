// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/storage/piece_file.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <new>

#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

constexpr std::array<char, kFirstRecordAt> kMagic = {'p', 'm', 'p', 'i', 'e', 'c', 'e', '1'};

// What stands before each payload.
struct RecordHead {
    std::uint32_t kind = 0;
    std::uint32_t reserved = 0;
    std::uint64_t payloadBytes = 0;
    std::uint64_t checksum = 0;  // of the payload, seeded with kind and length
};
static_assert(sizeof(RecordHead) == 24);

struct AreaBytes {
    std::uint32_t pass;
    std::int32_t x0, y0, x1, y1;
};
static_assert(sizeof(AreaBytes) == kAreaBytes);

std::uint64_t seedOf(std::uint32_t kind, std::uint64_t payloadBytes) {
    return (std::uint64_t{kind} << 32) ^ payloadBytes;
}

std::uint64_t checksumOf(std::uint32_t kind, std::span<const std::byte> payload) {
    return XXH3_64bits_withSeed(payload.data(), payload.size(), seedOf(kind, payload.size()));
}

// The same checksum of a payload that comes bit by bit.
class Checksum {
  public:
    Checksum(std::uint32_t kind, std::uint64_t payloadBytes) : m_state(XXH3_createState()) {
        if (!m_state) throw std::bad_alloc();
        XXH3_64bits_reset_withSeed(m_state.get(), seedOf(kind, payloadBytes));
    }
    void add(std::span<const std::byte> bytes) {
        XXH3_64bits_update(m_state.get(), bytes.data(), bytes.size());
    }
    std::uint64_t value() const { return XXH3_64bits_digest(m_state.get()); }

  private:
    struct Free {
        void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
    };
    std::unique_ptr<XXH3_state_t, Free> m_state;
};

// So much is read or written before anyone is asked whether to go on.
constexpr std::size_t kChunkBytes = std::size_t{1} << 22;

// Calls each(chunk) with the parts in order, in chunks.
template <typename Byte, typename Each>
void forEachChunk(std::span<const std::span<Byte>> parts, const BetweenChunks& between,
                  const Each& each) {
    for (std::span<Byte> part : parts) {
        while (!part.empty()) {
            between();
            const std::size_t bytes = std::min(part.size(), kChunkBytes);
            each(part.first(bytes));
            part = part.subspan(bytes);
        }
    }
}

template <typename Value>
void appendBytes(const Value& value, std::vector<std::byte>& bytes) {
    const std::size_t at = bytes.size();
    bytes.resize(at + sizeof value);
    std::memcpy(bytes.data() + at, &value, sizeof value);
}

}  // namespace

void appendRecord(PieceRecord kind, std::span<const std::byte> payload,
                  std::vector<std::byte>& bytes) {
    RecordHead head;
    head.kind = static_cast<std::uint32_t>(kind);
    head.payloadBytes = payload.size();
    head.checksum = checksumOf(head.kind, payload);
    bytes.reserve(bytes.size() + sizeof head + payload.size());
    appendBytes(head, bytes);
    bytes.insert(bytes.end(), payload.begin(), payload.end());
}

std::vector<std::byte> beginningOfPiece(const std::string& head) {
    std::vector<std::byte> bytes;
    appendBytes(kMagic, bytes);
    appendRecord(PieceRecord::kHead, std::as_bytes(std::span(head)), bytes);
    return bytes;
}

PieceReader::PieceReader(const OwnedFile& file) : m_file(file), m_size(file.size()) {
    m_isPiece = pm::plugin::isPiece(m_file);
    if (m_isPiece) m_whole = kMagic.size();
}

bool PieceReader::next(std::uint64_t mostBytes) {
    const auto place = m_isPiece ? findRecord(m_file, m_whole, m_size) : std::nullopt;
    if (!place) return false;
    // Before memory is taken for what may be the length of something broken.
    if (m_whole == kFirstRecordAt && place->payloadBytes > kLongestHead) return false;
    const bool isTaken = place->payloadBytes <= mostBytes;
    m_payload.resize(isTaken ? place->payloadBytes : 0);
    const std::array<std::span<std::byte>, 1> payload = {std::span(m_payload)};
    const BetweenChunks goOn = [] {};
    if (isTaken ? !readRecord(m_file, *place, payload, goOn) : !isWhole(m_file, *place, goOn))
        return false;
    m_kind = place->kind;
    m_whole = place->end();
    return true;
}

bool isPiece(const OwnedFile& file) {
    std::array<char, kMagic.size()> magic{};
    return file.readAt(0, std::as_writable_bytes(std::span(magic))) && magic == kMagic;
}

std::optional<RecordPlace> findRecord(const OwnedFile& file, std::uint64_t at,
                                      std::uint64_t fileSize) {
    RecordHead head;
    if (at > fileSize || fileSize - at < sizeof head) return std::nullopt;
    if (!file.readAt(at, std::as_writable_bytes(std::span(&head, 1)))) return std::nullopt;
    if (head.reserved != 0 || head.payloadBytes > fileSize - at - sizeof head) return std::nullopt;
    return RecordPlace{static_cast<PieceRecord>(head.kind), at + sizeof head, head.payloadBytes,
                       head.checksum};
}

RecordPlace writeRecord(const OwnedFile& file, std::uint64_t at, PieceRecord kind,
                        std::span<const std::span<const std::byte>> payload,
                        const BetweenChunks& between) {
    RecordHead head;
    head.kind = static_cast<std::uint32_t>(kind);
    for (const auto& part : payload) head.payloadBytes += part.size();
    Checksum checksum(head.kind, head.payloadBytes);
    std::uint64_t to = at + sizeof head;
    forEachChunk(payload, between, [&](std::span<const std::byte> chunk) {
        checksum.add(chunk);
        file.writeAt(to, chunk);
        to += chunk.size();
    });
    head.checksum = checksum.value();
    file.writeAt(at, std::as_bytes(std::span(&head, 1)));
    return {kind, at + sizeof head, head.payloadBytes, head.checksum};
}

bool readRecord(const OwnedFile& file, const RecordPlace& place,
                std::span<const std::span<std::byte>> payload, const BetweenChunks& between) {
    Checksum checksum(static_cast<std::uint32_t>(place.kind), place.payloadBytes);
    std::uint64_t from = place.payloadAt;
    bool isThere = true;
    forEachChunk(payload, between, [&](std::span<std::byte> chunk) {
        isThere = isThere && file.readAt(from, chunk);
        checksum.add(chunk);
        from += chunk.size();
    });
    return isThere && from == place.end() && checksum.value() == place.checksum;
}

bool isWhole(const OwnedFile& file, const RecordPlace& place, const BetweenChunks& between) {
    Checksum checksum(static_cast<std::uint32_t>(place.kind), place.payloadBytes);
    std::vector<std::byte> buffer(std::min<std::uint64_t>(place.payloadBytes, kChunkBytes));
    std::uint64_t left = place.payloadBytes;
    while (left > 0) {
        between();
        const auto chunk = std::span(buffer).first(std::min<std::uint64_t>(left, buffer.size()));
        if (!file.readAt(place.end() - left, chunk)) return false;
        checksum.add(chunk);
        left -= chunk.size();
    }
    return checksum.value() == place.checksum;
}

void appendArea(const PieceArea& area, std::vector<std::byte>& payload) {
    appendBytes(AreaBytes{area.pass, area.rect.x0, area.rect.y0, area.rect.x1, area.rect.y1},
                payload);
}

PieceArea takeArea(std::span<const std::byte>& payload) {
    AreaBytes bytes{};
    if (payload.size() < sizeof bytes)
        throw CallError(CallStatus::kFile, "a record without a rectangle");
    std::memcpy(&bytes, payload.data(), sizeof bytes);
    payload = payload.subspan(sizeof bytes);
    return {bytes.pass, {bytes.x0, bytes.y0, bytes.x1, bytes.y1}};
}

}  // namespace pm::plugin
