// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/src/piece_file.h"

#include <xxhash.h>

#include <array>
#include <cstring>

#include "plugin/src/call_error.h"

namespace pm::plugin {

namespace {

constexpr std::array<char, 8> kMagic = {'p', 'm', 'p', 'i', 'e', 'c', 'e', '1'};

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
static_assert(sizeof(AreaBytes) == 20);

std::uint64_t checksumOf(std::uint32_t kind, std::span<const std::byte> payload) {
    const std::uint64_t seed = (std::uint64_t{kind} << 32) ^ payload.size();
    return XXH3_64bits_withSeed(payload.data(), payload.size(), seed);
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
    std::array<char, kMagic.size()> magic{};
    m_isPiece = m_file.readAt(0, std::as_writable_bytes(std::span(magic))) && magic == kMagic;
    if (m_isPiece) m_whole = kMagic.size();
}

bool PieceReader::next() {
    RecordHead head;
    const std::uint64_t left = m_size - m_whole;
    if (!m_isPiece || left < sizeof head) return false;
    if (!m_file.readAt(m_whole, std::as_writable_bytes(std::span(&head, 1)))) return false;
    // Before memory is taken for what may be the length of something broken.
    if (head.reserved != 0 || head.payloadBytes > left - sizeof head) return false;
    m_payload.resize(head.payloadBytes);
    if (!m_file.readAt(m_whole + sizeof head, m_payload)) return false;
    if (checksumOf(head.kind, m_payload) != head.checksum) return false;
    m_kind = static_cast<PieceRecord>(head.kind);
    m_whole += sizeof head + head.payloadBytes;
    return true;
}

void appendArea(const PieceArea& area, std::vector<std::byte>& payload) {
    appendBytes(AreaBytes{area.pass, area.rect.x0, area.rect.y0, area.rect.x1, area.rect.y1},
                payload);
}

PieceArea takeArea(std::span<const std::byte>& payload) {
    AreaBytes bytes{};
    if (payload.size() < sizeof bytes)
        throw CallError(PMR_ERROR_FILE, "a record without a rectangle");
    std::memcpy(&bytes, payload.data(), sizeof bytes);
    payload = payload.subspan(sizeof bytes);
    return {bytes.pass, {bytes.x0, bytes.y0, bytes.x1, bytes.y1}};
}

}  // namespace pm::plugin
