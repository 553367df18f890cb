// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/storage/part_file.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <utility>

#include "plugin/storage/owned_file.h"
#include "plugin/storage/piece_file.h"
#include "plugin/storage/temporary_file.h"
#include "plugin/values/call_error.h"
#include "scheduler/film/frame_store_bytes.h"

namespace pm::plugin {

namespace {

CallError damaged(const std::string& file, const std::string& why) {
    return {CallStatus::kFile, fmt::format("{}: {}", file, why)};
}

// Calls `onRecord` with every record up to the end of the part, and checks that it is whole. Of
// records with more bytes than these the payload is empty.
template <typename OnRecord>
void forEachRecord(const OwnedFile& file, std::uint64_t mostBytes, OnRecord onRecord) {
    PieceReader reader(file);
    if (!reader.isPiece()) throw damaged(file.name(), "is no part of a picture");
    bool ended = false;
    std::uint64_t records = 0, told = 0;
    while (!ended && reader.next(mostBytes)) {
        ended = reader.kind() == PieceRecord::kEnd;
        if (ended && reader.payload().size() == sizeof told)
            std::copy_n(reader.payload().data(), sizeof told, reinterpret_cast<std::byte*>(&told));
        else if (!ended)
            ++records;
        if (!ended) onRecord(reader, records);
    }
    if (!ended || told != records || reader.isBroken())
        throw damaged(file.name(), ended
                                       ? "the part is damaged behind its end"
                                       : fmt::format("the part is damaged or cut short at byte {}",
                                                     reader.wholeBytes()));
}

}  // namespace

void checkPartIsWritable(const std::string& file) {
    const TemporaryFile probe(file);
}

void writePart(const std::string& file, const PieceHead& head, const FrameStore& frame,
               std::span<const Rect> buckets) {
    TemporaryFile part(file);
    part.append(beginningOfPiece(head.toJson()));
    std::vector<std::byte> payload, record;
    for (const Rect& bucket : buckets) {
        payload.clear();
        record.clear();
        appendArea({0, bucket}, payload);
        FrameStoreBytes::append(frame, bucket, payload);
        appendRecord(PieceRecord::kSums, payload, record);
        part.append(record);
    }
    const std::uint64_t records = buckets.size() + 1;
    record.clear();
    appendRecord(PieceRecord::kEnd, std::as_bytes(std::span(&records, 1)), record);
    part.append(record);
    part.sync();
    part.commit();
}

void readPart(const std::string& name, const std::function<std::uint64_t(const PieceHead&)>& onHead,
              const std::function<void(const Rect&, std::span<const std::byte>)>& onBucket) {
    const OwnedFile file(name, O_RDONLY);
    PieceHead head;
    std::uint64_t buckets = 0;
    forEachRecord(file, kLongestHead, [&](const PieceReader& reader, std::uint64_t record) {
        const bool isHead = record == 1;
        if (isHead != (reader.kind() == PieceRecord::kHead))
            throw damaged(name, "a record where it does not belong");
        if (!isHead) {
            ++buckets;
            return;
        }
        try {
            head = PieceHead::fromJson(reader.payload());
        } catch (const CallError& error) {
            throw damaged(name, error.what());
        }
        if (head.kind != PieceKind::kPart)
            throw damaged(name, fmt::format("is {}, no part of a picture", kindName(head.kind)));
    });
    if (buckets != head.range.count()) throw damaged(name, "the part has not all of its buckets");
    const std::uint64_t mostBytes = std::max(kLongestHead, kAreaBytes + onHead(head));
    forEachRecord(file, mostBytes, [&](const PieceReader& reader, std::uint64_t record) {
        if (record == 1) return;
        std::span<const std::byte> payload = reader.payload();
        const PieceArea area = takeArea(payload);
        onBucket(area.rect, payload);
    });
}

}  // namespace pm::plugin
