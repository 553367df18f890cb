// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/folders/own_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <optional>

#include "host_shim/pictures/finished_file.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMarker = ".pm-folder";
constexpr std::string_view kMarkerBegins = "pm-folder/1 ";
constexpr std::size_t kMostMarkerBytes = 512;

fs::path markerOf(const fs::path& folder) {
    return folder / kMarker;
}

// The beginning of a regular file; nothing where there is none.
std::optional<std::string> beginningOf(const fs::path& file, std::size_t bytes) {
    const int opened =
        ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY);
    if (opened < 0) return std::nullopt;
    struct stat status {};
    std::string text(bytes, '\0');
    const bool isRegular = ::fstat(opened, &status) == 0 && S_ISREG(status.st_mode);
    const ssize_t got = isRegular ? ::read(opened, text.data(), text.size()) : -1;
    ::close(opened);
    if (got < 0) return std::nullopt;
    text.resize(static_cast<std::size_t>(got));
    return text;
}

bool isMarker(std::string_view name) {
    return name == kMarker || name.starts_with(std::string(kMarker) + ".tmp.");
}

// What file systems, version control and network servers leave in empty folders.
bool isNoFile(std::string_view name) {
    return name == ".gitkeep" || name == "lost+found" || name.starts_with(".nfs") || isMarker(name);
}

// A file whose name isn't pm's; nothing where there is none.
std::optional<fs::path> foreignFile(const fs::path& folder, const FolderKind& kind) {
    std::error_code failed;
    for (fs::recursive_directory_iterator entry(folder, failed), end; !failed && entry != end;
         entry.increment(failed)) {
        const bool isFolder = entry->symlink_status().type() == fs::file_type::directory;
        const Own own =
            kind.isKnown == nullptr
                ? kind.ownership(entry->path().lexically_relative(folder).string(), isFolder)
                : Own::kNo;
        if (isNoFile(entry->path().filename().string()) || own == Own::kWithAllInIt) {
            entry.disable_recursion_pending();
        } else if (!isFolder && own == Own::kNo) {
            return entry->path();
        }
    }
    if (failed)
        throw HostError(ExitCode::kFile, fmt::format("{} {}: can't be read: {}", kind.option,
                                                     folder.string(), failed.message()));
    return std::nullopt;
}

[[noreturn]] void refuse(const fs::path& folder, const FolderKind& kind, const std::string& why) {
    throw HostError(ExitCode::kFile,
                    fmt::format("{} {}: {}; pm would replace and remove files there, so give it "
                                "{} that it made, or a folder that is empty or new",
                                kind.option, folder.string(), why, kind.name));
}

// Whether it has the marker already.
bool isMarkedAs(const fs::path& folder, const FolderKind& kind) {
    const auto marker = beginningOf(markerOf(folder), kMostMarkerBytes);
    if (!marker) return false;
    const std::string_view line = std::string_view(*marker).substr(0, marker->find('\n'));
    if (!line.starts_with(kMarkerBegins))
        refuse(folder, kind, fmt::format("its {} is not of this pm", kMarker));
    const std::string_view word = line.substr(kMarkerBegins.size());
    if (word != kind.word)
        refuse(folder, kind, fmt::format("is pm's for another purpose ({})", word));
    return true;
}

void refuseForeign(const fs::path& folder, const FolderKind& kind) {
    std::error_code failed;
    if (!fs::is_directory(folder, failed)) return;
    if (isMarkedAs(folder, kind) || (kind.isKnown != nullptr && kind.isKnown(folder))) return;
    if (const auto foreign = foreignFile(folder, kind))
        refuse(folder, kind,
               fmt::format("has {}, and no {} of pm's",
                           foreign->lexically_relative(folder).string(), kMarker));
}

bool mark(const fs::path& folder, const FolderKind& kind) {
    try {
        writeFinishedFile(
            markerOf(folder),
            fmt::format("{}{}\nThis folder is {} of pm_host, which writes, replaces and removes "
                        "files in it. Keep your own elsewhere.\n",
                        kMarkerBegins, kind.word, kind.name));
        return true;
    } catch (const HostError&) {
        return false;
    }
}

}  // namespace

OwnFolder::OwnFolder(const fs::path& folder, const FolderKind& kind)
    : m_path(fs::absolute(folder).lexically_normal()), m_kind(&kind) {
    refuseForeign(folder, kind);
    std::error_code failed;
    fs::create_directories(m_path, failed);
    m_isMarked = isMarkedAs(m_path, kind) || mark(m_path, kind);
}

void OwnFolder::check(const fs::path& folder, const FolderKind& kind) {
    refuseForeign(folder, kind);
}

bool OwnFolder::owns(const fs::path& file) const {
    return m_kind->ownership != nullptr &&
           m_kind->ownership(file.lexically_relative(m_path).string(), false) == Own::kYes;
}

void OwnFolder::remove(const fs::path& file) const {
    struct stat status {};
    if (owns(file) && ::lstat(file.c_str(), &status) == 0 && S_ISREG(status.st_mode))
        ::unlink(file.c_str());
}

bool beginsWith(const fs::path& file, std::string_view text) {
    std::string found = beginningOf(file, 2 * text.size() + kMostMarkerBytes).value_or("");
    std::string wanted(text);
    for (std::string* each : {&found, &wanted})
        std::erase_if(*each,
                      [](char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; });
    return found.starts_with(wanted);
}

bool isHex(std::string_view text, std::size_t length) {
    return text.size() == length && std::ranges::all_of(text, [](char c) {
               return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
           });
}

}  // namespace pm::host
