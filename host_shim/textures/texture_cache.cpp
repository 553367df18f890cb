// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/textures/texture_cache.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <pwd.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <tuple>
#include <unordered_set>

#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kSecondsOfADay = 24 * 60 * 60;
// Records of originals that nobody asked for that long are removed.
constexpr std::int64_t kOldIndex = 90 * kSecondsOfADay;
// Nobody writes one file for that long.
constexpr std::int64_t kOldTemporary = kSecondsOfADay;
// Between finding a texture and telling so in the lease nobody else may remove it.
constexpr std::int64_t kJustUsed = 60;

std::int64_t now() {
    return std::chrono::duration_cast<std::chrono::seconds>(
               std::chrono::system_clock::now().time_since_epoch())
        .count();
}

std::int64_t lastModified(const fs::path& file) {
    struct stat status {};
    return ::stat(file.c_str(), &status) == 0 ? std::int64_t{status.st_mtim.tv_sec} : 0;
}

void touch(const fs::path& file) {
    ::utimensat(AT_FDCWD, file.c_str(), nullptr, 0);
}

void removeFile(const fs::path& file) {
    ::unlink(file.c_str());
}

std::vector<fs::path> filesOf(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code failed;
    fs::directory_iterator entry(folder, failed);
    for (; !failed && entry != fs::directory_iterator(); entry.increment(failed))
        files.push_back(entry->path());
    return files;
}

constexpr std::size_t kHashDigits = 32;  // of hashText()

// Whether it is "NAME.HASH.tx" and the like, of a name that may be anything.
bool hasHashBefore(std::string_view name, std::string_view ending) {
    if (!name.ends_with(ending)) return false;
    name.remove_suffix(ending.size());
    return name.size() > kHashDigits + 1 && name[name.size() - kHashDigits - 1] == '.' &&
           isHex(name.substr(name.size() - kHashDigits), kHashDigits);
}

// A name of who writes a file until it is whole; left by one who was killed.
bool isTemporary(const fs::path& file) {
    const std::string name = file.filename().string();
    const std::size_t dot = name.find('.');
    if (dot == name.npos || !isUniqueName(std::string_view(name).substr(0, dot))) return false;
    const std::string_view ending = std::string_view(name).substr(dot);
    return ending == ".tx" || ending == ".rec" || ending == ".lease" ||
           (ending.starts_with(".tx.tmp.") && !hasHashBefore(name, ".tx"));
}

Own ownershipInCache(std::string_view place, bool isFolder) {
    const std::size_t slash = place.find('/');
    const std::string_view part = place.substr(0, slash);
    if (isFolder) {
        if (place == "copies") return Own::kWithAllInIt;  // of scenes, a folder of its own
        return place == "textures" || place == "index" || place == "leases" ? Own::kYes : Own::kNo;
    }
    if (slash == place.npos) return Own::kNo;
    const std::string_view name = place.substr(slash + 1);
    const bool isOurs =
        isTemporary(name) ||
        (part == "textures" && (hasHashBefore(name, ".tx") || hasHashBefore(name, ".rec"))) ||
        (part == "index" && name.ends_with(".rec") &&
         isHex(name.substr(0, name.size() - std::string_view(".rec").size()), kHashDigits));
    return isOurs ? Own::kYes : Own::kNo;
}

constexpr FolderKind kCacheKind{"texture-cache", "a texture cache", "--texture-cache",
                                ownershipInCache};

[[noreturn]] void failWriting(const fs::path& file) {
    throw HostError(ExitCode::kFile,
                    fmt::format("{}: can't be written: {}", file.string(), std::strerror(errno)));
}

}  // namespace

fs::path usualCacheFolder() {
    // By the XDG base directory specification others than absolute paths don't count.
    if (const char* base = std::getenv("XDG_CACHE_HOME"); base != nullptr && *base == '/')
        return fs::path(base) / "pm";
    if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/')
        return fs::path(home) / ".cache" / "pm";
    return {};
}

TextureCache::TextureCache(const fs::path& folder, std::uint64_t limitBytes)
    : m_own(folder, kCacheKind), m_limitBytes(limitBytes) {
    std::error_code failed;
    for (const char* part : {"textures", "index", "leases"})
        fs::create_directories(m_own.path() / part, failed);
    const fs::path probe = makeTemporaryBeside(m_own.path() / "textures" / "x.tx");
    if (probe.empty()) return;
    removeFile(probe);
    m_leaseFile = makeTemporaryBeside(m_own.path() / "leases" / "x.lease");
    if (m_leaseFile.empty()) return;
    m_lease = ::open(m_leaseFile.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC | O_NOFOLLOW);
    // Where files can't be locked, others go by the time of the last use alone.
    if (m_lease >= 0) ::flock(m_lease, LOCK_EX | LOCK_NB);
}

TextureCache::~TextureCache() {
    if (m_lease < 0) return;
    removeFile(m_leaseFile);
    ::close(m_lease);
}

fs::path TextureCache::textureFile(const std::string& name) const {
    return folder() / "textures" / (name + ".tx");
}

fs::path TextureCache::recordFile(const std::string& name) const {
    return folder() / "textures" / (name + ".rec");
}

std::optional<Record> TextureCache::original(const std::string& key) const {
    const fs::path file = folder() / "index" / (key + ".rec");
    auto record = Record::read(file);
    if (record && now() - lastModified(file) > kSecondsOfADay) touch(file);
    return record;
}

void TextureCache::putOriginal(const std::string& key, const Record& record) const {
    if (isWritable()) record.write(folder() / "index" / (key + ".rec"));
}

// Whoever changed the file changed its stamp; then all its bytes are looked at.
bool TextureCache::isWhole(const std::string& name, Record& record) const {
    const fs::path file = textureFile(name);
    const auto stamp = stampOf(file);
    if (!stamp) return false;
    if (stamp->text() == record.get("stamp")) return true;
    if (static_cast<std::int64_t>(stamp->size) != record.number("bytes")) return false;
    try {
        if (hashFile(file, {}) != record.get("checksum")) return false;
    } catch (const HostError&) {
        return false;
    }
    record.set("stamp", stamp->text());
    record.write(recordFile(name));
    return true;
}

std::optional<Record> TextureCache::find(const std::string& name) {
    auto record = Record::read(recordFile(name));
    if (!record) return std::nullopt;
    if (record->get("asItIs") == "1") {
        touch(recordFile(name));
        return record;
    }
    lease(name);
    touch(recordFile(name));
    if (!isWhole(name, *record)) return std::nullopt;
    return record;
}

void TextureCache::lease(const std::string& name) {
    if (!isWritable()) return;
    const std::lock_guard lock(m_mutex);
    const std::string line = name + "\n";
    // At worst another process makes room by it, and it is made again.
    [[maybe_unused]] const ssize_t written = ::write(m_lease, line.data(), line.size());
}

fs::path TextureCache::nameForNew() const {
    return folder() / "textures" / (uniqueName() + ".tx");
}

void TextureCache::noteUnderway(const fs::path& temporary) {
    const std::lock_guard lock(m_mutex);
    if (m_isAbandoned)
        throw HostError(ExitCode::kFile, fmt::format("{}: given up", temporary.string()));
    m_underway.push_back(temporary);
}

void TextureCache::abandon() {
    const std::lock_guard lock(m_mutex);
    m_isAbandoned = true;
    for (const fs::path& file : m_underway) removeFile(file);
    if (!m_leaseFile.empty()) removeFile(m_leaseFile);
}

void TextureCache::commitAsItIs(const std::string& name, Record record) const {
    record.set("asItIs", "1");
    record.write(recordFile(name));
}

void TextureCache::commit(const std::string& name, FinishedFile& texture, Record record) {
    lease(name);
    record.set("checksum", hashFile(texture.temporaryPath(), {}));
    texture.commitAs(textureFile(name));
    const auto stamp = stampOf(textureFile(name));
    if (!stamp) failWriting(textureFile(name));
    record.setNumber("bytes", static_cast<std::int64_t>(stamp->size));
    record.set("stamp", stamp->text());
    if (!record.write(recordFile(name))) failWriting(recordFile(name));
}

// A lease that can be locked belongs to nobody any more.
std::vector<std::string> TextureCache::leasedNames() const {
    std::vector<std::string> names;
    for (const fs::path& file : filesOf(folder() / "leases")) {
        const int lease = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
        if (lease < 0) continue;
        const bool isLeft = file != m_leaseFile && ::flock(lease, LOCK_EX | LOCK_NB) == 0 &&
                            now() - lastModified(file) > kJustUsed;
        if (isLeft) {
            m_own.remove(file);
        } else {
            std::ifstream lines(file);
            for (std::string name; std::getline(lines, name);) names.push_back(name);
        }
        ::close(lease);
    }
    return names;
}

std::vector<TextureCache::Entry> TextureCache::list() const {
    std::vector<Entry> entries;
    for (const fs::path& file : filesOf(folder() / "textures")) {
        if (file.extension() != ".tx" || isTemporary(file) || !m_own.owns(file)) continue;
        Entry entry;
        entry.name = file.stem().string();
        entry.file = file;
        entry.lastUsed = std::max(lastModified(file), lastModified(recordFile(entry.name)));
        if (const auto stamp = stampOf(file)) entry.bytes = stamp->size;
        if (const auto record = Record::read(recordFile(entry.name)))
            entry.source = record->get("source");
        entries.push_back(std::move(entry));
    }
    std::ranges::sort(entries, {}, [](const Entry& entry) {
        return std::tie(entry.lastUsed, entry.source, entry.name);
    });
    return entries;
}

void TextureCache::removeTexture(const std::string& name) const {
    m_own.remove(recordFile(name));
    m_own.remove(textureFile(name));
}

void TextureCache::removeLeftovers() const {
    const std::int64_t time = now();
    for (const char* part : {"textures", "index"})
        for (const fs::path& file : filesOf(folder() / part))
            if (isTemporary(file) && time - lastModified(file) > kOldTemporary) m_own.remove(file);
    for (const fs::path& file : filesOf(folder() / "index"))
        if (time - lastModified(file) > kOldIndex) m_own.remove(file);
    for (const fs::path& file : filesOf(folder() / "textures"))
        if (file.extension() == ".rec" && time - lastModified(file) > kOldIndex &&
            !fs::exists(textureFile(file.stem().string())))
            m_own.remove(file);
}

void TextureCache::makeRoom() {
    if (!isWritable()) return;
    removeLeftovers();
    const std::vector<Entry> entries = list();
    std::uint64_t bytes = 0;
    for (const Entry& entry : entries) bytes += entry.bytes;
    if (bytes <= m_limitBytes) return;
    const std::vector<std::string> leased = leasedNames();
    const std::unordered_set<std::string> used(leased.begin(), leased.end());
    for (const Entry& entry : entries) {
        if (bytes <= m_limitBytes) return;
        if (used.contains(entry.name)) continue;
        // Someone may have come to use it since.
        if (now() - lastModified(recordFile(entry.name)) < kJustUsed) continue;
        removeTexture(entry.name);
        bytes -= entry.bytes;
    }
}

std::size_t TextureCache::clear() {
    const std::vector<std::string> leased = leasedNames();
    const std::unordered_set<std::string> used(leased.begin(), leased.end());
    std::size_t count = 0;
    for (const fs::path& file : filesOf(folder() / "textures")) {
        if (!m_own.owns(file) || used.contains(file.stem().string())) continue;
        if (isTemporary(file) && now() - lastModified(file) < kOldTemporary) continue;
        count += file.extension() == ".tx" ? 1 : 0;
        m_own.remove(file);
    }
    for (const fs::path& file : filesOf(folder() / "index"))
        if (file.extension() == ".rec") m_own.remove(file);
    return count;
}

std::vector<std::string> TextureCache::verify(const std::function<void()>& goOn) {
    std::vector<std::string> faults;
    for (const Entry& entry : list()) {
        const auto record = Record::read(recordFile(entry.name));
        if (record && hashFile(entry.file, goOn) == record->get("checksum")) continue;
        faults.push_back(fmt::format("{}: damaged, removed", entry.file.string()));
        removeTexture(entry.name);
    }
    for (const fs::path& file : filesOf(folder() / "index")) {
        if (!m_own.owns(file) || isTemporary(file)) continue;
        const auto record = Record::read(file);
        if (!record) {
            m_own.remove(file);
            continue;
        }
        const fs::path source = record->get("source");
        const auto stamp = stampOf(source);
        if (!stamp || stamp->text() != record->get("stamp")) continue;  // it is looked at anew
        if (hashFile(source, goOn) == record->get("content")) continue;
        faults.push_back(
            fmt::format("{}: its bytes are others than its dates say; forgotten", source.string()));
        m_own.remove(file);
    }
    return faults;
}

}  // namespace pm::host
