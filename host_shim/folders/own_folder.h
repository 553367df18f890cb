// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace pm::host {

// Whether a name in a folder is one that pm gives there.
enum class Own { kNo, kYes, kWithAllInIt };

// What a folder is that pm keeps, and by what it knows one.
struct FolderKind {
    const char* word;    // in the marker: "texture-cache"
    const char* name;    // in messages: "a texture cache"
    const char* option;  // that names such a folder: "--texture-cache"
    // Of a place in it, such as "index/x.rec": a folder without a marker is of this kind when every
    // file in it is pm's by its name. None where isKnown says it.
    Own (*ownership)(std::string_view place, bool isFolder){};
    // Whether a folder without a marker is of this kind, by a file that pm alone writes.
    bool (*isKnown)(const std::filesystem::path& folder){};
};

// A folder whose files pm writes, replaces and removes. It has a marker, the file `.pm-folder`,
// which pm wrote when it made the folder or came to an empty one. A folder that has files and no
// marker is somebody's own, unless it is known to be of this kind; lost+found, .gitkeep and .nfs*
// are no files. Threads: any.
class OwnFolder {
  public:
    // Makes the folder where it isn't there, and marks it. Nothing is written into somebody's own.
    // Where nothing can be written isMarked() is false. Errors: HostError kFile for a folder that
    // is somebody's own, or pm's of another kind.
    OwnFolder(const std::filesystem::path& folder, const FolderKind& kind);

    // The same errors, and nothing is made.
    static void check(const std::filesystem::path& folder, const FolderKind& kind);

    // Absolute.
    const std::filesystem::path& path() const { return m_path; }
    bool isMarked() const { return m_isMarked; }

    // Whether pm gives a file below the folder such a name.
    bool owns(const std::filesystem::path& file) const;
    // Removes a file below the folder, if it is a regular one and pm's by its name.
    void remove(const std::filesystem::path& file) const;

  private:
    std::filesystem::path m_path;
    const FolderKind* m_kind;
    bool m_isMarked{};
};

// Whether a file begins with a text, white space in it left out; of a file that can't be read: no.
bool beginsWith(const std::filesystem::path& file, std::string_view text);

// Whether a text has so many characters, all of them 0 to 9 or a to f.
bool isHex(std::string_view text, std::size_t length);

}  // namespace pm::host
