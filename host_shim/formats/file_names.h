// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pm::host {

// Text up to a comment behind a blank: "wood.png # oak" is "wood.png". "Material #25" is
// "Material", so it is only for names that are not found as they stand.
std::string_view withoutComment(std::string_view text);

// The names of folders' entries without regard to case. A folder is listed once. Not for several
// threads.
class FolderNames {
  public:
    // The entry of folder that differs from name by the case of letters a to z only; of several the
    // first, as folders have no order.
    std::optional<std::string> inAnyCase(const std::filesystem::path& folder,
                                         const std::string& name);

  private:
    std::map<std::filesystem::path, std::map<std::string, std::string>> m_folders;
};

// What a file name may have been meant to be, the likeliest first: as it stands; without quotes or
// a comment; each with the slashes of another system; each in the other of UTF-8 and Windows' Latin
// letters.
std::vector<std::string> readingsOf(std::string_view name);

// What is left of a name of another machine when folders are taken from its front, the longest
// first: "C:\a\tex\red.png" and "..\..\a\tex\red.png" are "a/tex/red.png", "tex/red.png" and
// "red.png". At most 16 parts from the end; none for names like "red.png".
std::vector<std::string> tailsOf(std::string_view name);

// The file below folder that is called name, or that but for the case of letters. None where there
// is no regular file.
std::optional<std::filesystem::path> findFile(const std::filesystem::path& folder,
                                              const std::string& name, FolderNames& names);

}  // namespace pm::host
