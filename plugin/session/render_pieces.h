// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "plugin/session/setting_values.h"
#include "plugin/storage/bucket_range.h"
#include "plugin/storage/checkpoint.h"
#include "plugin/storage/piece_head.h"
#include "scheduler/buckets/bucket_grid.h"
#include "scheduler/film/frame_store.h"

namespace pm::plugin {

// The buckets that the setting asks for; all where it is empty. bucketCount: of the frame. Errors:
// CallError(ARGUMENT) for a run that is not there, or that goes with other settings badly.
BucketRange checkedRun(const SettingValues& values, bool isCorrelated, std::uint32_t bucketCount);

// What a render makes and keeps of itself in pieces: a run of its buckets only, a checkpoint, a
// part. Does nothing where the settings ask for none of them.
class RenderPieces {
  public:
    // Takes the settings' run out of the order, and opens and tries the files. Errors:
    // CallError(ARGUMENT) for settings that don't go together; those of Checkpoint and of
    // checkPartIsWritable.
    RenderPieces(const SettingValues& values, const Identity& scene, const BucketGrid& grid,
                 bool isCorrelated, std::vector<std::uint32_t>& order);

    struct Resumed {
        std::string file;                // the checkpoint; empty: none
        std::uint32_t passes = 0;        // whole ones
        double shareOfNext = 0;          // of its pixels
        std::uint64_t droppedBytes = 0;  // of a torn end
        bool replacesOther = false;      // a checkpoint that was there and was not to go on
        bool foundNone = false;          // there was none to go on from
    };
    // Puts what the checkpoint has into the empty frame; channels: floats that a pass has for each
    // pixel. Errors: those of Checkpoint::load.
    Resumed resume(FrameStore& frame, std::size_t channels, const std::atomic<bool>& cancelled);
    // Whether a part of the pass that comes next was there; until that has ended.
    bool isWithinPass() const { return m_checkpoint && m_checkpoint->done().count() > 0; }

    // Of a pass: the cells that are still to be rendered; all but in the pass that goes on.
    std::vector<std::uint32_t> remaining(std::span<const std::uint32_t> order) const;
    // Takes what a bucket gave in a pass: floats, `channels` a pixel, then weights, for the pixels
    // of rect, whole atoms. Calls add(rect, buffer) with what is to go into the frame: all of it,
    // or one by one the atoms that were not done before. Threads: any.
    using Add = std::function<void(const Rect& rect, std::span<const float> buffer)>;
    void takeBucket(std::uint32_t pass, const Rect& rect, std::span<const float> buffer,
                    std::size_t channels, const Add& add);
    void endPass(const FrameStore& frame, std::uint32_t passesDone,
                 const std::atomic<bool>& cancelled);
    // Why the checkpoint is not written any more, once; else empty.
    std::string takeTrouble();

    // The render has ended: writes the part. photonHash: PieceHead's. Errors: those of writePart.
    void finish(const FrameStore& frame, std::uint32_t passesDone,
                const std::string& photonHash) const;
    // The checkpoint stays, but is in use no more; see Checkpoint::close.
    void close(const std::atomic<bool>& cancelled) noexcept;

  private:
    const BucketGrid& m_grid;
    std::vector<Rect> m_buckets;  // of the run, in order
    std::uint64_t m_pixels = 0;   // of all of them
    PieceHead m_partHead;
    std::string m_part;  // empty: none
    std::string m_checkpointFile;
    std::unique_ptr<Checkpoint> m_checkpoint;  // null: none
};

}  // namespace pm::plugin
