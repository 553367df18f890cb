// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_shim/formats/file_names.h"

namespace pm::host {

// A scene that lies elsewhere than where its absolute names were written for.
struct MovedFolder {
    std::filesystem::path was, is;  // absolute
};

// Which files a scene may name beside those below its own folder.
struct SceneFileRules {
    // Where names are looked for that are not found beside the scene; in this order.
    std::vector<std::filesystem::path> searchPaths;
    bool isTrusted{true};                            // else nothing is opened that lies elsewhere
    std::vector<std::filesystem::path> alsoAllowed;  // for scenes that are not trusted
    // Absolute names below `was` mean the same below `is`; others mean nothing then.
    std::optional<MovedFolder> moved{};
};

// The one place where names in scene files (libraries and pictures) become files that are opened.
// Not for several threads.
class SceneFiles {
  public:
    // sceneFolder: where the scene's own file lies. Errors: kFile where a search path is no folder.
    SceneFiles(std::filesystem::path sceneFolder, SceneFileRules rules);

    // The regular file that a text in folder means by name: as readingsOf(name) below folder, else
    // as the tails of it; else the same below the scene's folder, and below each search path. None
    // where there is none, or none that may be opened; where scenes are not trusted, links have
    // been followed before that is asked, and the answer has none.
    std::optional<std::filesystem::path> find(const std::filesystem::path& folder,
                                              std::string_view name);
    // The same without tails, for texts that may be more than one name.
    std::optional<std::filesystem::path> findWhole(const std::filesystem::path& folder,
                                                   std::string_view name);

    const std::filesystem::path& folder() const { return m_sceneFolder; }
    bool isTrusted() const { return m_rules.isTrusted; }

    // "not found", and where was looked, for messages.
    std::string whyNone(const std::filesystem::path& folder, std::string_view name) const;

  private:
    // Below folder, the scene's folder and the search paths.
    std::optional<std::filesystem::path> findAnywhere(const std::filesystem::path& folder,
                                                      const std::vector<std::string>& names);
    std::optional<std::filesystem::path> findIn(const std::filesystem::path& folder,
                                                const std::string& name);
    std::optional<std::string> placeNow(const std::string& name) const;
    bool isAllowedByName(const std::filesystem::path& file) const;

    std::filesystem::path m_sceneFolder;
    SceneFileRules m_rules;
    std::vector<std::filesystem::path> m_roots;  // that may be read below; absolute, without links
    std::vector<std::filesystem::path> m_rootsByName;  // the same as they were written, and both
    FolderNames m_names;
};

}  // namespace pm::host
