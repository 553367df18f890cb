// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace pm::host {

// Where the files of a scene lie in a pack: as they do to each other, below the nearest folder that
// holds them all, so that every name by which one was found leads to its copy.
class PackPlaces {
  public:
    // As it was found, by a relative or absolute path. Errors: HostError kBadInput for a name that
    // is no UTF-8, and where two unlike files would have one place, as a link and ".." can make it.
    void addFile(const std::filesystem::path& file);
    void addSearchPath(const std::filesystem::path& folder);

    // Once all are there.
    std::filesystem::path base() const;
    std::string placeOf(const std::filesystem::path& path) const;  // "." for the base
    std::map<std::string, std::filesystem::path> files() const;    // place -> file
    // Folders that a path goes through and leaves again, by "..".
    std::vector<std::string> folders() const;

  private:
    void addFoldersLeft(const std::filesystem::path& path);

    std::map<std::filesystem::path, std::filesystem::path> m_files;  // by whole, plain paths
    std::set<std::filesystem::path> m_searchPaths, m_folders;
};

}  // namespace pm::host
