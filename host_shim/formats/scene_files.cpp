// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/scene_files.h"

#include <fmt/format.h>

#include <algorithm>

#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestName = 4096;  // longer ones no file system has

fs::path absoluteFolder(const fs::path& folder) {
    const fs::path full = fs::absolute(folder.empty() ? "." : folder).lexically_normal();
    return full.has_filename() ? full : full.parent_path();
}

bool isBelow(const fs::path& file, const fs::path& folder) {
    const auto [end, ignored] =
        std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
    return end == folder.end();
}

bool isBelowAny(const fs::path& file, const std::vector<fs::path>& folders) {
    return std::ranges::any_of(folders,
                               [&file](const fs::path& folder) { return isBelow(file, folder); });
}

}  // namespace

SceneFiles::SceneFiles(fs::path sceneFolder, SceneFileRules rules)
    : m_sceneFolder(std::move(sceneFolder)), m_rules(std::move(rules)) {
    std::error_code error;
    for (const fs::path& folder : m_rules.searchPaths)
        if (!fs::is_directory(folder, error))
            throw HostError(
                ExitCode::kFile,
                fmt::format("--search-path {}: there is no such folder", folder.string()));
    if (m_rules.isTrusted) return;
    std::vector<fs::path> folders{m_sceneFolder};
    folders.insert(folders.end(), m_rules.searchPaths.begin(), m_rules.searchPaths.end());
    folders.insert(folders.end(), m_rules.alsoAllowed.begin(), m_rules.alsoAllowed.end());
    for (const fs::path& folder : folders) {
        m_rootsByName.push_back(absoluteFolder(folder));
        const fs::path real = fs::canonical(m_rootsByName.back(), error);
        if (error) continue;
        m_roots.push_back(real);
        m_rootsByName.push_back(real);
    }
}

// Before anything is asked of the file system: a look at a name can be enough to mount a folder.
bool SceneFiles::isAllowedByName(const fs::path& file) const {
    return m_rules.isTrusted || isBelowAny(fs::absolute(file).lexically_normal(), m_rootsByName);
}

// Before a name is looked for: where an absolute one lies now. None: nowhere.
std::optional<std::string> SceneFiles::placeNow(const std::string& name) const {
    const fs::path path(name);
    if (!m_rules.moved || !path.is_absolute()) return name;
    const auto [end, rest] = std::mismatch(m_rules.moved->was.begin(), m_rules.moved->was.end(),
                                           path.begin(), path.end());
    if (end != m_rules.moved->was.end()) return std::nullopt;
    fs::path place = m_rules.moved->is;
    for (auto part = rest; part != path.end(); ++part) place /= *part;
    return place.string();
}

std::optional<fs::path> SceneFiles::findIn(const fs::path& folder, const std::string& asked) {
    const auto place = placeNow(asked);
    if (!place) return std::nullopt;
    const std::string& name = *place;
    if (name.find('\0') != name.npos || !isAllowedByName(folder / name)) return std::nullopt;
    auto file = findFile(folder, name, m_names);
    if (!file || m_rules.isTrusted) return file;
    std::error_code error;
    fs::path real = fs::canonical(*file, error);
    if (error || !isBelowAny(real, m_roots)) return std::nullopt;
    return real;
}

std::optional<fs::path> SceneFiles::findAnywhere(const fs::path& folder,
                                                 const std::vector<std::string>& names) {
    std::vector<fs::path> folders{folder};
    if (m_sceneFolder != folder) folders.push_back(m_sceneFolder);
    folders.insert(folders.end(), m_rules.searchPaths.begin(), m_rules.searchPaths.end());
    for (const fs::path& at : folders)
        for (const std::string& name : names)
            if (auto file = findIn(at, name)) return file;
    return std::nullopt;
}

std::optional<fs::path> SceneFiles::findWhole(const fs::path& folder, std::string_view name) {
    if (name.empty() || name.size() > kLongestName) return std::nullopt;
    return findAnywhere(folder, readingsOf(name));
}

std::optional<fs::path> SceneFiles::find(const fs::path& folder, std::string_view name) {
    if (name.empty() || name.size() > kLongestName) return std::nullopt;
    std::vector<std::string> names = readingsOf(name), tails;
    for (const std::string& reading : names)
        for (std::string& tail : tailsOf(reading))
            if (std::ranges::find(tails, tail) == tails.end()) tails.push_back(std::move(tail));
    std::ranges::stable_sort(tails, std::ranges::greater{},
                             [](const std::string& tail) { return std::ranges::count(tail, '/'); });
    std::ranges::move(tails, std::back_inserter(names));
    return findAnywhere(folder, names);
}

std::string SceneFiles::whyNone(const fs::path& folder, std::string_view name) const {
    std::string where = absoluteFolder(folder).string();
    if (absoluteFolder(m_sceneFolder) != absoluteFolder(folder))
        where += ", " + absoluteFolder(m_sceneFolder).string();
    for (const fs::path& path : m_rules.searchPaths) where += ", " + path.string();
    return fmt::format("'{}' is no file below {}{}", name, where,
                       m_rules.isTrusted ? " (--search-path DIR adds a folder)"
                                         : "; --untrusted allows no other folder "
                                           "(--search-path DIR adds one)");
}

}  // namespace pm::host
