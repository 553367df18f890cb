// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/copies/copies_folder.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
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

// False where there is no such content any more.
bool linkTo(const fs::path& object, const fs::path& place) {
    if (isSameFile(object, place)) return true;
    std::error_code ignored;
    fs::remove_all(place, ignored);
    if (::link(object.c_str(), place.c_str()) == 0) return true;
    if (errno == EEXIST && isSameFile(object, place)) return true;  // someone else did the same
    if (errno == ENOENT) return false;
    fail(place, fmt::format("can't be linked to {}: {}; --copies DIR on a file system with hard "
                            "links is wanted",
                            object.string(), std::strerror(errno)));
}

}  // namespace

CopiesFolder::CopiesFolder(fs::path folder, std::uint64_t limitBytes, Log& log)
    : m_folder(fs::absolute(folder).lexically_normal()), m_limitBytes(limitBytes), m_log(log) {
    for (const char* part : {"objects", "packs"}) makeFolder(m_folder / part);
}

fs::path CopiesFolder::object(const std::string& sha256) const {
    return m_folder / objectPath(sha256);
}

fs::path CopiesFolder::tree(const std::string& id) const {
    return m_folder / "packs" / id;
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
    std::error_code ignored;
    fs::remove_all(object, ignored);
    return false;
}

std::vector<std::string> CopiesFolder::missing(const Manifest& manifest) const {
    std::set<std::string> seen;
    std::vector<std::string> missing;
    for (const PackedFile& file : manifest.files)
        if (seen.insert(file.sha256).second && !isWhole(file)) missing.push_back(file.sha256);
    return missing;
}

// Another file in the right place would be read as well: a sidecar, a picture that is looked for
// there first.
void CopiesFolder::removeStrangers(const std::string& id, const Manifest& manifest) const {
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
    for (const fs::path& stranger : strangers) {
        m_log.warning(
            static_cast<int>(Warning::kCopies),
            fmt::format("{}: does not belong to the scene; it is removed", stranger.string()));
        std::error_code ignored;
        fs::remove_all(stranger, ignored);
    }
}

bool CopiesFolder::layOut(const std::string& id, const Manifest& manifest) const {
    makeFolder(tree(id));
    removeStrangers(id, manifest);
    for (const std::string& folder : foldersOf(manifest)) makeFolder(tree(id) / folder);
    return std::ranges::all_of(manifest.files, [&](const PackedFile& file) {
        return linkTo(object(file.sha256), tree(id) / file.place);
    });
}

}  // namespace pm::host
