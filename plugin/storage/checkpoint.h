// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>

#include "plugin/storage/disk_thread.h"
#include "plugin/storage/done_pixels.h"
#include "plugin/storage/owned_file.h"
#include "plugin/storage/piece_head.h"
#include "plugin/storage/temporary_file.h"
#include "scheduler/film/frame_store.h"

namespace pm::plugin {

// A render's finished work on disk, so that one that was killed at any moment goes on from there
// with the same bits.
//
// The file is a piece: the sums of the frame after so many whole passes, then what each bucket gave
// in the passes since, appended as they finish. A record that was torn by the end of the process
// fails its checksum; it and what follows it are dropped and rendered again. When the records
// outgrow the sums, the file is replaced between two passes by one of sums only, in one step.
// Records are with the system at once, so they outlive the process, and are synced about once a
// second, so a power cut costs little more than that. Syncs have a thread of their own: no worker
// waits for a disk. The file is locked while it is in use.
class Checkpoint {
  public:
    // Opens or makes the file; head: this render's, passes and range left alone. With resume it
    // must be of the same render where it is there, without it a checkpoint that is there is
    // begun anew. Errors: CallError(MISMATCH) for another render's, saying what differs;
    // CallError(FILE) for what is no checkpoint; CallError(IO) when it can't be written or another
    // render uses it.
    Checkpoint(const std::string& file, bool resume, PieceHead head, const Rect& window);
    // Removes a file that it made and that nothing came into. Waits for a sync that is on its way.
    ~Checkpoint();
    Checkpoint(const Checkpoint&) = delete;
    Checkpoint& operator=(const Checkpoint&) = delete;

    // Puts what there is into the frame, which is empty. channels: floats that a pass has for each
    // pixel; pixels: of all buckets of a pass. Returns the number of whole passes; of the next one
    // done() is there too. Errors: CallError(FILE) where the file is damaged; Error(kCancelled).
    std::uint32_t load(FrameStore& frame, std::size_t channels, std::uint64_t pixels,
                       const std::atomic<bool>& cancelled);
    // Of the pass that goes on; nothing from the next pass on.
    const DonePixels& done() const { return m_done; }
    // Whether one was there and was begun anew.
    bool replacesOther() const { return m_replacesOther; }
    // It was to go on from one, and none was there.
    bool foundNone() const { return m_foundNone; }
    // Of a torn end that load() dropped.
    std::uint64_t droppedBytes() const { return m_droppedBytes; }

    // What a bucket gave in a pass: floats a pixel, then weights, as it went into the frame.
    // Threads: any. Never throws: see takeTrouble.
    void addBucket(std::uint32_t pass, const Rect& rect, std::span<const float> buffer) noexcept;
    // Between two passes; so many are whole now. Never throws.
    void endPass(const FrameStore& frame, std::uint32_t passesDone,
                 const std::atomic<bool>& cancelled) noexcept;
    // Lets others have the file; synced before, unless `cancelled` is set, which ends the waiting:
    // the system has everything anyway, and writes it within half a minute or so.
    void close(const std::atomic<bool>& cancelled) noexcept;

    // Why nothing is saved any more, once; empty while all is well. The render can go on without.
    std::string takeTrouble();

  private:
    void open(const std::string& file);
    bool make(const std::string& file);
    void writeHead(TemporaryFile& file);
    void take(bool resume);
    void refuseOtherPieces() const;
    void readHead();
    void beginAnew();
    void loadSums(std::span<const std::byte> payload, FrameStore& frame);
    void loadPass(std::span<const std::byte> payload, FrameStore& frame, std::uint64_t pixels);
    void writeSums(const FrameStore& frame, std::uint32_t passesDone,
                   const std::atomic<bool>& cancelled);
    void syncNowAndThen();
    void throwTroubleOfDisk();
    // Called while an exception is handled.
    void giveUp() noexcept;

    PieceHead m_head;
    DonePixels m_done;
    std::uint32_t m_passes = 0;  // whole ones while loading
    std::size_t m_channels = 0;
    std::uint64_t m_sumPixels = 0;  // loaded
    std::uint64_t m_droppedBytes = 0;
    bool m_isNew = false;  // made or begun anew by this
    bool m_replacesOther = false;
    bool m_foundNone = false;

    std::atomic<bool> m_off{false};     // nothing is written any more
    std::mutex m_mutex;                 // of what follows
    std::shared_ptr<OwnedFile> m_file;  // kept open by a sync that is on its way
    std::uint64_t m_end = 0;            // where the next record goes
    std::uint64_t m_sumsEnd = 0;        // where the records of passes begin
    std::chrono::steady_clock::time_point m_synced;
    std::string m_trouble;
    DiskThread m_disk;  // last: it ends first
};

}  // namespace pm::plugin
