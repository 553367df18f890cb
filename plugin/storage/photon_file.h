// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// A photon map on disk: the photons of passes 0 to n-1 and those of the pilots, as they were
// traced. It is a piece: a head, then a record for each kind of photons of the pilots and of each
// pass, in the order of tracing, then an end. Any pass can be read first, and no more than one kind
// of one pass is in memory, whatever the number of passes.
//
// It holds photons and no maps. Maps are made of them anew, which takes a small part of the time of
// tracing; and what depends on the camera (gather points, irradiance where it is asked for) is made
// when it is asked for, as without the file.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "integrator/photons/trace/photon_store.h"
#include "integrator/transport/plan/plan.h"
#include "plugin/storage/disk_thread.h"
#include "plugin/storage/owned_file.h"
#include "plugin/storage/piece_file.h"
#include "plugin/storage/piece_head.h"
#include "plugin/storage/temporary_file.h"

namespace pm::plugin {

// Writes the file; it takes its name when it is whole and synced. A full disk leaves nothing.
class PhotonFileWriter : public PhotonSink {
  public:
    // head: of photonHead(). Errors: CallError(FILE) where another kind of file is in the way,
    // CallError(IO) where it can't be written.
    PhotonFileWriter(const std::string& file, const PieceHead& head);

    // Errors: CallError(IO); Error(kCancelled).
    void write(PhotonKind kind, std::uint32_t pass, const PhotonTraceResult& traced,
               const std::atomic<bool>& cancelled) override;
    // After the last pass. Errors: CallError(IO); Error(kCancelled), after which it can't be gone
    // on with.
    void finish(const std::atomic<bool>& cancelled);

    // Removes what there is, without waiting for the disk; nothing may follow.
    void abandon() noexcept;

    std::uint64_t bytes() const { return m_end; }  // so far; any thread
    // Of all photons, once they are written; 32 hexadecimal digits.
    std::string hash() const;

  private:
    void throwTroubleOfDisk();

    TemporaryFile m_file;
    std::atomic<std::uint64_t> m_end{0};  // where the next record goes
    std::uint64_t m_records = 1;          // the head
    std::vector<std::uint64_t> m_checksums;
    DiskThread m_disk;  // last: it ends first
};

// Reads the file. Threads: const members from any, at once.
class PhotonFileReader : public PhotonSource {
  public:
    // What a render needs of the file.
    struct Wanted {
        PieceHead head;  // of photonHead(), with the passes of the render
        Plan plan;
        double sceneRadius = 0;  // Scene::radius
    };
    // Checks all but the photons themselves. Errors: CallError(FILE) where there is no such file,
    // it is no photon map or it is damaged; CallError(MISMATCH) where it is of other photons,
    // saying what differs, or holds fewer passes; CallError(IO) where it can't be read.
    PhotonFileReader(const std::string& file, Wanted wanted);

    // Reads all passes that are wanted once and checks them, so that damage is found before the
    // first pixel. Errors: as read().
    void checkAll(const std::atomic<bool>& cancelled) const;
    // Errors: CallError(FILE) where it is damaged, CallError(IO), Error(kCancelled).
    PhotonTraceResult read(PhotonKind kind, std::uint32_t pass,
                           const std::atomic<bool>& cancelled) const override;
    // Reads twice where it is not one round: once to see that it is whole.
    PhotonTraceResult readInRounds(PhotonKind kind, std::uint32_t pass,
                                   const std::atomic<bool>& cancelled,
                                   const TraceRounds& rounds) const override;

    std::uint32_t passes() const { return m_passes; }  // that it holds
    std::uint64_t bytes() const { return m_size; }
    // Of the photons of so many passes and of the pilots; 32 hexadecimal digits. The same as that
    // of a file with no more passes.
    std::string hash(std::uint32_t passes) const;

  private:
    // Photons of one kind.
    struct Entry {
        RecordPlace place;
        std::uint64_t photons = 0, descended = 0, received = 0;
    };
    void readHead();
    void readEntries();
    std::size_t entriesOf(std::uint32_t passes) const;
    const Entry& entry(PhotonKind kind, std::uint32_t pass) const;
    [[noreturn]] void throwDamaged(const Entry& from, const char* fault) const;

    const Wanted m_wanted;
    OwnedFile m_file;
    std::uint64_t m_size = 0;
    std::uint32_t m_passes = 0;
    std::vector<PhotonKind> m_pilots, m_kinds;  // of the pilots, and of each pass
    std::vector<Entry> m_entries;               // in the order of the file
};

// The head of the photon map of a render with this identity (see photonIdentity) and so many
// passes.
PieceHead photonHead(const Identity& identity, std::uint32_t passes);

}  // namespace pm::plugin
