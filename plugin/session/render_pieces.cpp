// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/render_pieces.h"

#include <fmt/format.h>

#include <algorithm>

#include "plugin/session/picture_head.h"
#include "plugin/storage/part_file.h"
#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

// A run of buckets must be the same one on every machine, and all runs of as many passes.
void checkRun(const SettingValues& values, bool isCorrelated) {
    if (values.word(Setting::kBuckets).empty()) return;
    const auto refuse = [](const char* what) {
        throw argumentError(fmt::format("setting buckets does not go together with {}", what));
    };
    if (isCorrelated) refuse("the bucket order correlated");
    if (values.integer(Setting::kBucketSize) == 0) refuse("buckets of a size chosen by itself");
    if (values.number(Setting::kTimeLimit) > 0) refuse("timeLimitSeconds");
    if (values.number(Setting::kErrorTarget) > 0) refuse("errorTarget");
}

// Of the buffer of rect that of a part of it.
std::vector<float> cutOut(const Rect& rect, const Rect& part, std::span<const float> buffer,
                          std::size_t channels) {
    std::vector<float> cut;
    const std::span<const float> weights =
        buffer.subspan(static_cast<std::size_t>(rect.area()) * channels);
    const auto append = [&](std::span<const float> from, std::size_t floats) {
        for (std::int32_t y = part.y0; y < part.y1; ++y) {
            const std::int64_t pixel = std::int64_t{y - rect.y0} * rect.width() + part.x0 - rect.x0;
            const auto row = from.subspan(static_cast<std::size_t>(pixel) * floats,
                                          static_cast<std::size_t>(part.width()) * floats);
            cut.insert(cut.end(), row.begin(), row.end());
        }
    };
    append(buffer, channels);
    append(weights, 1);
    return cut;
}

}  // namespace

BucketRange checkedRun(const SettingValues& values, bool isCorrelated, std::uint32_t bucketCount) {
    checkRun(values, isCorrelated);
    return bucketRange(values.word(Setting::kBuckets), bucketCount);
}

RenderPieces::RenderPieces(const SettingValues& values, const Identity& scene,
                           const BucketGrid& grid, bool isCorrelated,
                           std::vector<std::uint32_t>& order)
    : m_grid(grid), m_part(values.word(Setting::kPart)) {
    const auto bucketCount = static_cast<std::uint32_t>(order.size());
    const BucketRange range = checkedRun(values, isCorrelated, bucketCount);
    order = {order.begin() + range.first, order.begin() + range.last};
    for (const std::uint32_t cell : order) m_buckets.push_back(grid.cellRect(cell));
    for (const Rect& bucket : m_buckets) m_pixels += static_cast<std::uint64_t>(bucket.area());

    const std::string gridText =
        fmt::format("{} pixels in {} order", grid.bucketSize(), values.word(Setting::kBucketOrder));
    if (!m_part.empty()) {
        checkPartIsWritable(m_part);
        m_partHead = makePieceHead(PieceKind::kPart, scene, values);
        m_partHead.identity.push_back({"buckets", gridText});
        m_partHead.bucketCount = bucketCount;
        m_partHead.range = range;
    }
    const std::string& file = values.word(Setting::kCheckpoint);
    if (file.empty()) return;
    PieceHead head = makePieceHead(PieceKind::kCheckpoint, scene, values);
    head.bucketCount = bucketCount;
    head.range = {0, bucketCount};
    if (range.count() < bucketCount) {
        // Which pixels these are depends on the grid; of a whole frame any grid can go on.
        head.range = range;
        head.identity.push_back(
            {"run of buckets", fmt::format("{} of {}", rangeText(range), gridText)});
    }
    m_checkpointFile = file;
    m_checkpoint = std::make_unique<Checkpoint>(file, values.integer(Setting::kResume) != 0,
                                                std::move(head), grid.window());
}

RenderPieces::Resumed RenderPieces::resume(FrameStore& frame, std::size_t channels,
                                           const std::atomic<bool>& cancelled) {
    Resumed resumed;
    if (!m_checkpoint) return resumed;
    resumed.file = m_checkpointFile;
    resumed.passes = m_checkpoint->load(frame, channels, m_pixels, cancelled);
    resumed.shareOfNext =
        static_cast<double>(m_checkpoint->done().count()) / static_cast<double>(m_pixels);
    resumed.replacesOther = m_checkpoint->replacesOther();
    resumed.foundNone = m_checkpoint->foundNone();
    resumed.droppedBytes = m_checkpoint->droppedBytes();
    return resumed;
}

std::vector<std::uint32_t> RenderPieces::remaining(std::span<const std::uint32_t> order) const {
    std::vector<std::uint32_t> cells(order.begin(), order.end());
    if (isWithinPass())
        std::erase_if(cells, [this](std::uint32_t cell) {
            return m_checkpoint->done().hasAll(m_grid.cellRect(cell));
        });
    return cells;
}

void RenderPieces::takeBucket(std::uint32_t pass, const Rect& rect, std::span<const float> buffer,
                              std::size_t channels, const Add& add) {
    const auto take = [&](const Rect& part, std::span<const float> floats) {
        add(part, floats);
        if (m_checkpoint) m_checkpoint->addBucket(pass, part, floats);
    };
    if (!isWithinPass() || !m_checkpoint->done().hasAny(rect)) return take(rect, buffer);
    for (std::int32_t y = rect.y0; y < rect.y1; y += kAtomSizePixels) {
        for (std::int32_t x = rect.x0; x < rect.x1; x += kAtomSizePixels) {
            const Rect atom{x, y, x + kAtomSizePixels, y + kAtomSizePixels};
            if (!m_checkpoint->done().hasAny(atom))
                take(atom, cutOut(rect, atom, buffer, channels));
        }
    }
}

void RenderPieces::endPass(const FrameStore& frame, std::uint32_t passesDone,
                           const std::atomic<bool>& cancelled) {
    if (m_checkpoint) m_checkpoint->endPass(frame, passesDone, cancelled);
}

std::string RenderPieces::takeTrouble() {
    return m_checkpoint ? m_checkpoint->takeTrouble() : std::string();
}

void RenderPieces::finish(const FrameStore& frame, std::uint32_t passesDone,
                          const std::string& photonHash) const {
    if (m_part.empty()) return;
    PieceHead head = m_partHead;
    head.passes = passesDone;
    head.photonHash = photonHash;
    head.sharesNoise = !frame.rule() || frame.rule()->sharesNoise;
    head.identity.push_back({"passes", fmt::format("{}", passesDone)});
    writePart(m_part, head, frame, m_buckets);
}

void RenderPieces::close(const std::atomic<bool>& cancelled) noexcept {
    if (m_checkpoint) m_checkpoint->close(cancelled);
}

}  // namespace pm::plugin
