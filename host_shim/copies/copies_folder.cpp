// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/copies/copies_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <set>

#include "host_shim/copies/sha256.h"
#include "host_shim/formats/warnings.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::string& why) {
    throw HostError(ExitCode::kFile, fmt::format("{}: {}", path.string(), why));
}

void makeFolder(const fs::path& folder) {
    throwIfInterrupted();
    std::error_code failed;
    fs::create_directories(folder, failed);
    if (failed) fail(folder, "can't be made: " + failed.message());
}

bool isSameFile(const fs::path& a, const fs::path& b) {
    struct stat first {
    }, second{};
    return ::lstat(a.c_str(), &first) == 0 && ::lstat(b.c_str(), &second) == 0 &&
           S_ISREG(first.st_mode) && first.st_dev == second.st_dev && first.st_ino == second.st_ino;
}

// Contents can't be written to, and stand among the objects as well.
bool isCopy(const fs::path& path) {
    struct stat status {};
    constexpr mode_t kWritable = 0222;
    return ::lstat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode) &&
           (status.st_nlink > 1 || (status.st_mode & kWritable) == 0);
}

// All folders that places lie in, and those that are there without.
std::set<std::string> foldersOf(const Manifest& manifest) {
    std::set<std::string> folders;
    const auto addUp = [&](fs::path folder) {
        for (; !folder.empty(); folder = folder.parent_path())
            if (!folders.insert(folder.string()).second) return;
    };
    for (const std::string& folder : manifest.folders) addUp(folder);
    for (const std::string& folder : manifest.searchPaths)
        if (folder != ".") addUp(folder);
    for (const PackedFile& file : manifest.files) addUp(fs::path(file.place).parent_path());
    return folders;
}

// Whether a name is that of a content or a manifest, or of one that is being written.
bool isContentName(std::string_view name, std::string_view ending) {
    const std::string_view hash = name.substr(0, name.find('.'));
    const std::string_view rest = name.substr(hash.size());
    return isSha256(hash) && (rest == ending || rest.starts_with(std::string(ending) + ".tmp."));
}

// What lies in the folder of a scene is pm's, but for strangers.
Own ownershipInCopies(std::string_view place, bool isFolder) {
    const std::size_t slash = place.find('/');
    const std::string_view part = place.substr(0, slash);
    if (slash == place.npos) {
        if (place == "set_aside" && isFolder) return Own::kWithAllInIt;
        return (isFolder ? place == "objects" || place == "packs" : place == "lock") ? Own::kYes
                                                                                     : Own::kNo;
    }
    const std::string_view rest = place.substr(slash + 1);
    if (part == "packs") {
        if (isFolder) return isSha256(rest) ? Own::kWithAllInIt : Own::kNo;
        return isContentName(rest, ".json") ? Own::kYes : Own::kNo;
    }
    constexpr std::size_t kDigits = 2;  // of a content's folder
    const std::string_view first = rest.substr(0, rest.find('/'));
    const bool isOurs = part == "objects" && isHex(first, kDigits) &&
                        (isFolder ? rest == first
                                  : rest.size() > first.size() &&
                                        isContentName(rest.substr(first.size() + 1), "") &&
                                        rest.substr(first.size() + 1).starts_with(first));
    return isOurs ? Own::kYes : Own::kNo;
}

constexpr FolderKind kCopiesKind{"copies", "a folder of copies of scenes", "--copies",
                                 ownershipInCopies};

}  // namespace

CopiesFolder::CopiesFolder(const fs::path& folder, std::uint64_t limitBytes, Log& log)
    : m_own(folder, kCopiesKind), m_limitBytes(limitBytes), m_log(log) {
    for (const char* part : {"objects", "packs"}) makeFolder(path() / part);
}

bool CopiesFolder::isWritable() const {
    return m_own.isMarked() && ::access((path() / "objects").c_str(), W_OK) == 0 &&
           ::access((path() / "packs").c_str(), W_OK) == 0;
}

fs::path CopiesFolder::object(const std::string& sha256) const {
    return path() / objectPath(sha256);
}

fs::path CopiesFolder::tree(const std::string& id) const {
    return path() / "packs" / id;
}

bool CopiesFolder::isWhole(const PackedFile& file) const {
    const fs::path object = this->object(file.sha256);
    struct stat status {};
    if (::lstat(object.c_str(), &status) != 0) return false;
    const bool isRightSize =
        S_ISREG(status.st_mode) && static_cast<std::uint64_t>(status.st_size) == file.bytes;
    if (isRightSize &&
        sha256OfFile(object, [](std::string_view) { throwIfInterrupted(); }) == file.sha256)
        return true;
    m_log.warning(static_cast<int>(Warning::kCopies),
                  fmt::format("{}: the copy of {} is not what it was; it is fetched anew",
                              object.string(), file.place));
    if (S_ISREG(status.st_mode))
        m_own.remove(object);
    else
        setAside(object);
    return false;
}

std::vector<std::string> CopiesFolder::missing(const Manifest& manifest) const {
    std::set<std::string> seen;
    std::vector<std::string> missing;
    for (const PackedFile& file : manifest.files)
        if (seen.insert(file.sha256).second && !isWhole(file)) missing.push_back(file.sha256);
    return missing;
}

// Somebody laid it there, who may want it back.
void CopiesFolder::setAside(const fs::path& path) const {
    constexpr int kMostNames = 1000;
    const fs::path folder = this->path() / "set_aside";
    makeFolder(folder);
    for (int i = 0; i < kMostNames; ++i) {
        const fs::path to =
            folder / (path.filename().string() + (i == 0 ? "" : fmt::format(".{}", i)));
        if (::renameat2(AT_FDCWD, path.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) {
            m_log.warning(static_cast<int>(Warning::kCopies),
                          fmt::format("{}: does not belong to the scene; it is now {}",
                                      path.string(), to.string()));
            return;
        }
        if (errno == ENOENT) return;  // another process did the same
        if (errno != EEXIST) break;
    }
    fail(path, fmt::format("does not belong to the scene, and can't be moved to {}: {}",
                           folder.string(), std::strerror(errno)));
}

// Another file in the right place would be read as well: a sidecar, a picture that is looked for
// there first.
void CopiesFolder::setAsideStrangers(const std::string& id, const Manifest& manifest) const {
    const fs::path tree = this->tree(id);
    const std::set<std::string> folders = foldersOf(manifest);
    std::set<std::string> files;
    for (const PackedFile& file : manifest.files) files.insert(file.place);
    std::vector<fs::path> strangers;
    std::error_code failed;
    for (fs::recursive_directory_iterator entry(tree, failed), end; !failed && entry != end;
         entry.increment(failed)) {
        const std::string place = entry->path().lexically_relative(tree).string();
        const bool isFolder = entry->symlink_status().type() == fs::file_type::directory;
        if ((isFolder ? folders : files).contains(place)) continue;
        if (isFolder) entry.disable_recursion_pending();
        strangers.push_back(entry->path());
    }
    if (failed) fail(tree, "can't be read: " + failed.message());
    for (const fs::path& stranger : strangers) setAside(stranger);
}

bool CopiesFolder::link(const fs::path& object, const fs::path& place) const {
    if (isSameFile(object, place)) return true;
    // A content that was fetched anew has another inode than the one that is linked here.
    if (isCopy(place))
        ::unlink(place.c_str());
    else if (fs::exists(fs::symlink_status(place)))
        setAside(place);
    if (::link(object.c_str(), place.c_str()) == 0) return true;
    if (errno == EEXIST && isSameFile(object, place)) return true;  // someone else did the same
    if (errno == ENOENT) return false;
    fail(place, fmt::format("can't be linked to {}: {}; --copies DIR on a file system with hard "
                            "links is wanted",
                            object.string(), std::strerror(errno)));
}

void CopiesFolder::removePack(const std::string& id) const {
    std::vector<fs::path> folders{tree(id)};
    std::error_code failed;
    for (fs::recursive_directory_iterator entry(tree(id), failed), end; !failed && entry != end;
         entry.increment(failed)) {
        if (entry->symlink_status().type() == fs::file_type::directory)
            folders.push_back(entry->path());
        else if (isCopy(entry->path()))
            ::unlink(entry->path().c_str());
        else
            setAside(entry->path());
    }
    // What a folder lies in stands before it.
    for (auto folder = folders.rbegin(); folder != folders.rend(); ++folder)
        ::rmdir(folder->c_str());
    m_own.remove(path() / "packs" / (id + ".json"));
}

bool CopiesFolder::layOut(const std::string& id, const Manifest& manifest) const {
    makeFolder(tree(id));
    setAsideStrangers(id, manifest);
    for (const std::string& folder : foldersOf(manifest)) makeFolder(tree(id) / folder);
    return std::ranges::all_of(manifest.files, [&](const PackedFile& file) {
        throwIfInterrupted();
        return link(object(file.sha256), tree(id) / file.place);
    });
}

}  // namespace pm::host
