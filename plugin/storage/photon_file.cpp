// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/storage/photon_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
#include <system_error>
#include <utility>

#include "integrator/photons/trace/photon_bytes.h"
#include "integrator/values/error.h"
#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

namespace fs = std::filesystem;

// Photons that are read at a time, at least.
constexpr std::uint64_t kFewestOfARound = 8192;

CallError unusable(const std::string& file, const std::string& why) {
    return {CallStatus::kFile, fmt::format("{}: {}", file, why)};
}

BetweenChunks stopIf(const std::atomic<bool>& cancelled, const char* what) {
    return [&cancelled, what] {
        if (cancelled.load(std::memory_order_relaxed)) throw Error(Status::kCancelled, what);
    };
}

BetweenChunks goOn() {
    return [] {};
}

std::string hashOf(std::span<const std::uint64_t> checksums) {
    const XXH128_hash_t hash = XXH3_128bits(checksums.data(), checksums.size_bytes());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

// A name that may be written to: free, or a photon map's, which is replaced.
const std::string& checkedName(const std::string& file) {
    std::error_code error;
    if (!fs::exists(file, error)) return file;
    if (fs::is_regular_file(file, error)) {
        const OwnedFile there(file, O_RDONLY);
        PieceReader reader(there);
        try {
            if (reader.next() && reader.kind() == PieceRecord::kHead &&
                PieceHead::fromJson(reader.payload()).kind == PieceKind::kPhotonMap)
                return file;
        } catch (const CallError&) {
            // None of ours.
        }
    }
    throw unusable(file, "is there and no photon map; it would be overwritten");
}

// In the order of tracing.
std::vector<PhotonKind> pilotKinds(const Plan& plan) {
    std::vector<PhotonKind> kinds;
    if (plan.globalMap) kinds.push_back(PhotonKind::kGlobalPilot);
    if (plan.causticMap) kinds.push_back(PhotonKind::kCausticPilot);
    return kinds;
}

std::vector<PhotonKind> passKinds(const Plan& plan) {
    std::vector<PhotonKind> kinds;
    if (plan.causticMap) kinds.push_back(PhotonKind::kCaustic);
    if (plan.globalMap) kinds.push_back(PhotonKind::kGlobal);
    return kinds;
}

bool isPilot(PhotonKind kind) {
    return kind == PhotonKind::kGlobalPilot || kind == PhotonKind::kCausticPilot;
}

}  // namespace

PieceHead photonHead(const Identity& identity, std::uint32_t passes) {
    PieceHead head;
    head.kind = PieceKind::kPhotonMap;
    head.identity = buildIdentity();
    head.identity.insert(head.identity.end(), identity.begin(), identity.end());
    head.sceneHash = identityHash(identity);
    for (const IdentityPart& part : identity)
        if (part.name == "instruction set") head.isa = part.value;
    head.passes = passes;
    return head;
}

PhotonFileWriter::PhotonFileWriter(const std::string& file, const PieceHead& head)
    : m_file(checkedName(file)) {
    m_file.append(beginningOfPiece(head.toJson()));
    m_end = m_file.file()->size();
}

void PhotonFileWriter::write(PhotonKind kind, std::uint32_t pass, const PhotonTraceResult& traced,
                             const std::atomic<bool>& cancelled) {
    const TracedHead head = tracedHead(kind, pass, traced);
    const RecordPlace place =
        writeRecord(*m_file.file(), m_end, PieceRecord::kPhotons, tracedBytes(head, traced),
                    stopIf(cancelled, "cancelled while writing photons"));
    m_end = place.end();
    m_checksums.push_back(place.checksum);
    ++m_records;
    throwTroubleOfDisk();
    // So that little is left to wait for at the end.
    if (m_disk.isIdle()) m_disk.give([file = m_file.file()] { file->sync(); });
}

void PhotonFileWriter::finish(const std::atomic<bool>& cancelled) {
    const std::array<std::span<const std::byte>, 1> count = {
        std::as_bytes(std::span(&m_records, 1))};
    m_end = writeRecord(*m_file.file(), m_end, PieceRecord::kEnd, count, goOn()).end();
    m_disk.give([file = m_file.file()] { file->sync(); });
    if (!m_disk.waitUntilIdle(cancelled))
        throw Error(Status::kCancelled, "cancelled while writing photons");
    throwTroubleOfDisk();
    m_file.commit();
}

void PhotonFileWriter::throwTroubleOfDisk() {
    if (const std::string text = m_disk.takeTrouble(); !text.empty())
        throw CallError(CallStatus::kIo, text);
}

void PhotonFileWriter::abandon() noexcept {
    m_file.remove();
}

std::string PhotonFileWriter::hash() const {
    return hashOf(m_checksums);
}

PhotonFileReader::PhotonFileReader(const std::string& file, Wanted wanted)
    : m_wanted(std::move(wanted)),
      m_pilots(pilotKinds(m_wanted.plan)),
      m_kinds(passKinds(m_wanted.plan)) {
    std::error_code error;
    if (!fs::exists(file, error) && !error)
        throw unusable(file, "there is no such photon map; a render of photons only makes one");
    if (fs::exists(file, error) && !fs::is_regular_file(file, error))
        throw unusable(file, "is no photon map, nor a file at all");
    m_file = OwnedFile(file, O_RDONLY);
    m_size = m_file.size();
    readHead();
    readEntries();
}

void PhotonFileReader::readHead() {
    if (!isPiece(m_file)) throw unusable(m_file.name(), "is no photon map");
    const auto place = findRecord(m_file, kFirstRecordAt, m_size);
    std::vector<std::byte> text;
    if (place && place->kind == PieceRecord::kHead && place->payloadBytes <= kLongestHead)
        text.resize(place->payloadBytes);
    const std::array<std::span<std::byte>, 1> payload = {std::span(text)};
    if (text.empty() || !readRecord(m_file, *place, payload, goOn()))
        throw unusable(m_file.name(), "the photon map is damaged: its head is broken");
    PieceHead head;
    try {
        head = PieceHead::fromJson(text);
    } catch (const CallError& error) {
        throw unusable(m_file.name(), error.what());
    }
    if (head.kind != PieceKind::kPhotonMap)
        throw unusable(m_file.name(), fmt::format("is {}, no photon map", kindName(head.kind)));
    const std::string others = differences(head.identity, m_wanted.head.identity);
    if (!others.empty())
        throw CallError(CallStatus::kMismatch,
                        fmt::format("{}: the photon map is of other photons; it differs in: {}",
                                    m_file.name(), others));
    m_passes = head.passes;
    if (m_passes < m_wanted.head.passes)
        throw CallError(CallStatus::kMismatch,
                        fmt::format("{}: the photon map holds {} passes; up to {} were asked for",
                                    m_file.name(), m_passes, m_wanted.head.passes));
}

// Finds where all records are, without reading their photons.
void PhotonFileReader::readEntries() {
    const auto damaged = [&](std::uint64_t at) {
        return unusable(m_file.name(),
                        fmt::format("the photon map is damaged or cut short at byte {}", at));
    };
    std::uint64_t at = findRecord(m_file, kFirstRecordAt, m_size)->end();
    const std::size_t count = m_pilots.size() + std::size_t{m_passes} * m_kinds.size();
    for (std::size_t i = 0; i < count; ++i) {
        const auto place = findRecord(m_file, at, m_size);
        TracedHead head;
        if (!place || place->kind != PieceRecord::kPhotons || place->payloadBytes < sizeof head ||
            !m_file.readAt(place->payloadAt, std::as_writable_bytes(std::span(&head, 1))))
            throw damaged(at);
        const std::size_t ofPass = i - std::min(i, m_pilots.size());
        const PhotonKind kind =
            i < m_pilots.size() ? m_pilots[i] : m_kinds[ofPass % m_kinds.size()];
        const std::size_t pass = i < m_pilots.size() ? 0 : ofPass / m_kinds.size();
        if (head.kind != static_cast<std::uint32_t>(kind) || head.pass != pass ||
            !fillsExactly(head, place->payloadBytes - sizeof head))
            throw damaged(at);
        m_entries.push_back({*place, head.photons, head.descended, head.received});
        at = place->end();
    }
    const auto end = findRecord(m_file, at, m_size);
    std::uint64_t told = 0;
    const std::array<std::span<std::byte>, 1> payload = {
        std::as_writable_bytes(std::span(&told, 1))};
    if (!end || end->kind != PieceRecord::kEnd || end->payloadBytes != sizeof told ||
        !readRecord(m_file, *end, payload, goOn()) || told != count + 1)
        throw damaged(at);
    if (end->end() != m_size)
        throw unusable(m_file.name(), "the photon map is damaged behind its end");
}

std::size_t PhotonFileReader::entriesOf(std::uint32_t passes) const {
    return m_pilots.size() + std::size_t{passes} * m_kinds.size();
}

void PhotonFileReader::checkAll(const std::atomic<bool>& cancelled) const {
    const BetweenChunks between = stopIf(cancelled, "cancelled while reading photons");
    for (std::size_t i = 0; i < entriesOf(m_wanted.head.passes); ++i)
        if (!isWhole(m_file, m_entries[i].place, between))
            throw unusable(m_file.name(), fmt::format("the photon map is damaged at byte {}",
                                                      m_entries[i].place.payloadAt));
}

const PhotonFileReader::Entry& PhotonFileReader::entry(PhotonKind kind, std::uint32_t pass) const {
    const std::vector<PhotonKind>& kinds = isPilot(kind) ? m_pilots : m_kinds;
    const auto found = std::ranges::find(kinds, kind);
    if (found == kinds.end() || pass >= m_passes)
        throw CallError(CallStatus::kInternal,
                        fmt::format("photons of pass {} are not in the photon map", pass));
    return m_entries[(isPilot(kind) ? 0 : entriesOf(pass)) +
                     static_cast<std::size_t>(found - kinds.begin())];
}

PhotonTraceResult PhotonFileReader::read(PhotonKind kind, std::uint32_t pass,
                                         const std::atomic<bool>& cancelled) const {
    const Entry& from = entry(kind, pass);
    // Sizes of what was found when the file was opened; the file may be another one by now.
    TracedHead head, found;
    found.photons = from.photons;
    found.descended = from.descended;
    found.received = from.received;
    PhotonTraceResult traced;
    const auto room = tracedRoom(found, traced);
    const std::array<std::span<std::byte>, 4> payload = {
        std::as_writable_bytes(std::span(&head, 1)), room[0], room[1], room[2]};
    const bool isWhole = readRecord(m_file, from.place, payload,
                                    stopIf(cancelled, "cancelled while reading photons"));
    const char* fault = "a checksum is wrong";
    if (isWhole && head.photons == found.photons && head.descended == found.descended &&
        head.received == found.received)
        fault = faultOf(head, traced, m_wanted.sceneRadius);
    if (fault != nullptr) throwDamaged(from, fault);
    traced.focus = head.focus;
    traced.balance = head.balance;
    return traced;
}

void PhotonFileReader::throwDamaged(const Entry& from, const char* fault) const {
    throw unusable(m_file.name(), fmt::format("the photon map is damaged at byte {}: {}",
                                              from.place.payloadAt, fault));
}

PhotonTraceResult PhotonFileReader::readInRounds(PhotonKind kind, std::uint32_t pass,
                                                 const std::atomic<bool>& cancelled,
                                                 const TraceRounds& rounds) const {
    if (rounds.bytes == TraceRounds::kAll)
        return PhotonSource::readInRounds(kind, pass, cancelled, rounds);
    const Entry& from = entry(kind, pass);
    const BetweenChunks between = stopIf(cancelled, "cancelled while reading photons");
    if (!isWhole(m_file, from.place, between)) throwDamaged(from, "a checksum is wrong");
    TracedHead head;
    std::uint64_t at = from.place.payloadAt;
    const auto readInto = [&](std::span<std::byte> bytes) {
        if (!m_file.readAt(at, bytes)) throwDamaged(from, "it ends too soon");
        at += bytes.size();
    };
    readInto(std::as_writable_bytes(std::span(&head, 1)));
    if (head.photons != from.photons || head.descended != from.descended ||
        head.received != from.received)
        throwDamaged(from, "its photons are miscounted");
    const auto takeAll = [&](std::uint64_t count, auto member) {
        while (count > 0) {
            between();
            PhotonTraceResult part;
            auto& photons = part.*member;
            const std::uint64_t most = std::max<std::uint64_t>(
                rounds.bytes / 2 / sizeof(photons.front()), kFewestOfARound);
            photons.resize(std::min(count, most));
            readInto(std::as_writable_bytes(std::span(photons)));
            if (const char* const fault = faultOf(head, part, m_wanted.sceneRadius))
                throwDamaged(from, fault);
            count -= photons.size();
            rounds.take(std::move(part));
        }
    };
    takeAll(head.photons, &PhotonTraceResult::photons);
    takeAll(head.descended, &PhotonTraceResult::descended);
    takeAll(head.received, &PhotonTraceResult::received);
    PhotonTraceResult rest;
    rest.focus = head.focus;
    rest.balance = head.balance;
    return rest;
}

std::string PhotonFileReader::hash(std::uint32_t passes) const {
    std::vector<std::uint64_t> checksums;
    for (std::size_t i = 0; i < entriesOf(std::min(passes, m_passes)); ++i)
        checksums.push_back(m_entries[i].place.checksum);
    return hashOf(checksums);
}

}  // namespace pm::plugin
