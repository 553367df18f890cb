// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/storage/checkpoint.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <filesystem>
#include <utility>
#include <vector>

#include "integrator/values/error.h"
#include "plugin/storage/piece_file.h"
#include "plugin/storage/temporary_file.h"
#include "plugin/values/call_error.h"
#include "scheduler/film/frame_store_bytes.h"

namespace pm::plugin {

namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kBetweenSyncs{1};
constexpr std::uint64_t kSumsRecordBytes = std::uint64_t{1} << 24;  // about so many each

// A name that leads nowhere else: a rename would replace a link, not what it leads to, which need
// not be there yet.
std::string withoutLinks(const std::string& file) {
    constexpr int kMostLinks = 40;  // as the kernel has it
    std::error_code error;
    fs::path path(file);
    for (int i = 0; i < kMostLinks && fs::is_symlink(path, error); ++i) {
        const fs::path target = fs::read_symlink(path, error);
        if (error) break;
        path = target.is_absolute() ? target : path.parent_path() / target;
    }
    return path.string();
}

CallError unusable(const std::string& file, const std::string& why) {
    return {CallStatus::kFile, fmt::format("{}: {}", file, why)};
}

// What a frame holds in rectangles of whole rows, of which each fits into a record.
std::vector<Rect> bandsOf(const FrameStore& frame) {
    const Rect area = FrameStoreBytes::area(frame);
    const std::uint64_t rowBytes =
        static_cast<std::uint64_t>(area.width()) * FrameStoreBytes::bytesPerPixel(frame);
    const auto rows =
        static_cast<std::int32_t>(std::max<std::uint64_t>(1, kSumsRecordBytes / rowBytes));
    std::vector<Rect> bands;
    for (std::int32_t y = area.y0; y < area.y1; y += rows)
        bands.push_back({area.x0, y, area.x1, std::min(area.y1, y + rows)});
    return bands;
}

// Returns the size; less than all is there once `cancelled` is set.
std::uint64_t writeBands(const FrameStore& frame, const PieceHead& head, const OwnedFile& file,
                         const std::atomic<bool>& cancelled) {
    std::vector<std::byte> payload, bytes = beginningOfPiece(head.toJson());
    std::uint64_t end = 0;
    for (const Rect& band : bandsOf(frame)) {
        if (cancelled) break;
        payload.clear();
        appendArea({0, band}, payload);
        FrameStoreBytes::append(frame, band, payload);
        appendRecord(PieceRecord::kSums, payload, bytes);
        file.writeAt(end, bytes);
        end += bytes.size();
        bytes.clear();
    }
    return end;
}

}  // namespace

Checkpoint::Checkpoint(const std::string& file, bool resume, PieceHead head, const Rect& window)
    : m_head(std::move(head)), m_done(window) {
    open(withoutLinks(file));
    m_foundNone = resume && m_isNew;
    if (!m_isNew) take(resume);
}

void Checkpoint::take(bool resume) {
    // Also an empty file is somebody's: what begins here has its head from the start.
    if (!PieceReader(*m_file).isPiece())
        throw unusable(m_file->name(), "is there and no checkpoint; it would be overwritten");
    if (resume) return readHead();
    m_replacesOther = true;
    refuseOtherPieces();
    beginAnew();
}

Checkpoint::~Checkpoint() {
    const bool isEmpty = m_isNew && m_file && m_end == m_sumsEnd;
    const std::shared_ptr<const OwnedFile> file = m_file;
    close(std::atomic<bool>(true));
    if (isEmpty) ::unlink(file->name().c_str());
}

void Checkpoint::open(const std::string& file) {
    constexpr int kTries = 10;  // of taking it over from a render that replaces it meanwhile
    for (int i = 0; i < kTries; ++i) {
        std::error_code ignored;
        if (!fs::exists(file, ignored)) {
            m_isNew = make(file);
            if (m_isNew) return;
        }
        m_file = std::make_shared<OwnedFile>(file, O_RDWR);
        if (!m_file->lock()) break;
        if (m_file->isAtItsName()) return;
    }
    m_file = nullptr;
    throw CallError(CallStatus::kIo, fmt::format("{}: another render uses this checkpoint", file));
}

// A part or photons would be lost without a word; a checkpoint, damaged or not, is begun anew.
void Checkpoint::refuseOtherPieces() const {
    PieceReader reader(*m_file);
    if (!reader.next() || reader.kind() != PieceRecord::kHead) return;
    PieceKind kind = PieceKind::kCheckpoint;
    try {
        kind = PieceHead::fromJson(reader.payload()).kind;
    } catch (const CallError&) {
        return;
    }
    if (kind != PieceKind::kCheckpoint)
        throw unusable(m_file->name(), fmt::format("is {}, no checkpoint; it would be overwritten",
                                                   kindName(kind)));
}

void Checkpoint::readHead() {
    PieceReader reader(*m_file);
    if (!reader.next() || reader.kind() != PieceRecord::kHead)
        throw unusable(m_file->name(), "the checkpoint is damaged: its head is broken");
    PieceHead found;
    try {
        found = PieceHead::fromJson(reader.payload());
    } catch (const CallError& error) {
        throw unusable(m_file->name(), error.what());
    }
    if (found.kind != PieceKind::kCheckpoint)
        throw unusable(m_file->name(), fmt::format("is {}, no checkpoint", kindName(found.kind)));
    if (const std::string text = differences(found.identity, m_head.identity); !text.empty())
        throw CallError(CallStatus::kMismatch,
                        fmt::format("{}: the checkpoint is of another render; it differs in: {}",
                                    m_file->name(), text));
    m_head.passes = found.passes;
}

void Checkpoint::beginAnew() {
    TemporaryFile next(m_file->name());
    writeHead(next);
    next.commit();
    m_isNew = true;
    m_file = next.file();
}

// False where somebody has the name by now.
bool Checkpoint::make(const std::string& file) {
    TemporaryFile next(file);
    writeHead(next);
    if (!next.commitNew()) return false;
    m_file = next.file();
    return true;
}

void Checkpoint::writeHead(TemporaryFile& file) {
    file.file()->lock();
    const std::vector<std::byte> bytes = beginningOfPiece(m_head.toJson());
    file.append(bytes);
    file.sync();
    m_end = m_sumsEnd = bytes.size();
}

std::uint32_t Checkpoint::load(FrameStore& frame, std::size_t channels, std::uint64_t pixels,
                               const std::atomic<bool>& cancelled) {
    m_channels = channels;
    PieceReader reader(*m_file);
    reader.next();
    m_sumsEnd = reader.wholeBytes();
    m_passes = m_head.passes;
    bool passesBegan = false;
    try {
        const std::uint64_t perPixel = std::max<std::uint64_t>(
            FrameStoreBytes::bytesPerPixel(frame), (channels + 1) * sizeof(float));
        const std::uint64_t mostBytes =
            kAreaBytes + perPixel * static_cast<std::uint64_t>(FrameStoreBytes::area(frame).area());
        while (reader.next(mostBytes)) {
            if (cancelled) throw Error(Status::kCancelled, "cancelled while resuming");
            if (reader.kind() == PieceRecord::kSums && !passesBegan) {
                loadSums(reader.payload(), frame);
                m_sumsEnd = reader.wholeBytes();
            } else if (reader.kind() == PieceRecord::kPass) {
                passesBegan = true;
                loadPass(reader.payload(), frame, pixels);
            } else {
                throw CallError(CallStatus::kFile, "a record where it does not belong");
            }
        }
    } catch (const CallError& error) {
        throw unusable(m_file->name(), fmt::format("the checkpoint is damaged: {}", error.what()));
    }
    // The sums came in one step, so what is missing of them was not lost by a torn write.
    const auto all = static_cast<std::uint64_t>(FrameStoreBytes::area(frame).area());
    if (m_sumPixels != (m_head.passes > 0 ? all : 0))
        throw unusable(m_file->name(), "the checkpoint is damaged: its sums are broken");
    m_droppedBytes = reader.brokenBytes();
    m_end = reader.wholeBytes();
    m_file->truncate(m_end);
    return m_passes;
}

void Checkpoint::loadSums(std::span<const std::byte> payload, FrameStore& frame) {
    const PieceArea area = takeArea(payload);
    try {
        FrameStoreBytes::restore(frame, area.rect, payload);
    } catch (const Error& error) {
        throw CallError(CallStatus::kFile, error.what());
    }
    m_sumPixels += static_cast<std::uint64_t>(area.rect.area());
}

void Checkpoint::loadPass(std::span<const std::byte> payload, FrameStore& frame,
                          std::uint64_t pixels) {
    const PieceArea area = takeArea(payload);
    if (area.pass != m_passes || area.rect.empty() ||
        intersect(area.rect, FrameStoreBytes::area(frame)) != area.rect)
        throw CallError(CallStatus::kFile, "a bucket of a pass where it does not belong");
    if (m_done.hasAny(area.rect)) throw CallError(CallStatus::kFile, "a bucket that comes twice");
    const auto count = static_cast<std::size_t>(area.rect.area());
    const std::size_t values = count * m_channels;
    if (payload.size() != (values + count) * sizeof(float))
        throw CallError(CallStatus::kFile, "a bucket of another size than its rectangle");
    std::vector<float> buffer(values + count);
    std::memcpy(buffer.data(), payload.data(), payload.size());
    frame.addPass(area.pass, area.rect, std::span(buffer).first(values),
                  std::span(buffer).subspan(values));
    m_done.add(area.rect);
    if (m_done.count() < pixels) return;
    ++m_passes;
    m_done.clear();
}

void Checkpoint::addBucket(std::uint32_t pass, const Rect& rect,
                           std::span<const float> buffer) noexcept {
    if (m_off) return;
    try {
        std::vector<std::byte> payload, record;
        payload.reserve(buffer.size_bytes() + sizeof(PieceArea));
        appendArea({pass, rect}, payload);
        const auto bytes = std::as_bytes(buffer);
        payload.insert(payload.end(), bytes.begin(), bytes.end());
        appendRecord(PieceRecord::kPass, payload, record);
        {
            const std::lock_guard lock(m_mutex);
            if (m_off) return;
            m_file->writeAt(m_end, record);
            m_end += record.size();
        }
        syncNowAndThen();
    } catch (...) {
        giveUp();
    }
}

// A disk that has not done with the last one yet gets no other.
void Checkpoint::syncNowAndThen() {
    throwTroubleOfDisk();
    const std::lock_guard lock(m_mutex);
    const auto now = std::chrono::steady_clock::now();
    if (m_off || now - m_synced < kBetweenSyncs || !m_disk.isIdle()) return;
    m_synced = now;
    m_disk.give([file = m_file] { file->sync(); });
}

void Checkpoint::throwTroubleOfDisk() {
    if (const std::string text = m_disk.takeTrouble(); !text.empty())
        throw CallError(CallStatus::kIo, text);
}

void Checkpoint::giveUp() noexcept {
    const std::lock_guard lock(m_mutex);
    if (m_off.exchange(true)) return;
    try {
        try {
            throw;
        } catch (const std::exception& error) {
            m_trouble = error.what();
        }
        m_file->truncate(m_end);
    } catch (...) {
        // What is torn at the end will be dropped by whoever resumes.
    }
}

void Checkpoint::endPass(const FrameStore& frame, std::uint32_t passesDone,
                         const std::atomic<bool>& cancelled) noexcept {
    if (m_off) return;
    try {
        throwTroubleOfDisk();
        m_done.clear();
        const std::uint64_t sums = static_cast<std::uint64_t>(FrameStoreBytes::area(frame).area()) *
                                   FrameStoreBytes::bytesPerPixel(frame);
        if (m_end - m_sumsEnd > sums) writeSums(frame, passesDone, cancelled);
    } catch (...) {
        giveUp();
    }
}

void Checkpoint::writeSums(const FrameStore& frame, std::uint32_t passesDone,
                           const std::atomic<bool>& cancelled) {
    PieceHead head = m_head;
    head.passes = passesDone;
    const std::string name = m_file->name();
    TemporaryFile next(name);
    const std::shared_ptr<OwnedFile>& file = next.file();
    file->lock();
    const std::uint64_t end = writeBands(frame, head, *file, cancelled);
    if (cancelled) return;
    m_disk.give([file] { file->sync(); });
    if (!m_disk.waitUntilIdle(cancelled)) return;
    throwTroubleOfDisk();
    next.rename();
    m_disk.give([name] { syncFolderOf(name); });
    m_head = std::move(head);
    m_file = file;
    m_end = m_sumsEnd = end;
    m_isNew = false;
    m_synced = std::chrono::steady_clock::now();
}

void Checkpoint::close(const std::atomic<bool>& cancelled) noexcept {
    const std::lock_guard lock(m_mutex);
    m_off = true;
    if (!m_file) return;
    try {
        try {
            if (!cancelled) m_disk.give([file = m_file] { file->sync(); });
            m_disk.waitUntilIdle(cancelled);
            throwTroubleOfDisk();
        } catch (const std::exception& error) {
            m_trouble = error.what();
        }
    } catch (...) {
        // No memory for the text.
    }
    // A sync that is on its way keeps the file open, but not from others.
    m_file->unlock();
    m_file = nullptr;
}

std::string Checkpoint::takeTrouble() {
    const std::lock_guard lock(m_mutex);
    return std::exchange(m_trouble, {});
}

}  // namespace pm::plugin
