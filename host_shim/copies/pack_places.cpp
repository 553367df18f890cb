// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/copies/pack_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

fs::path plain(const fs::path& path) {
    const fs::path whole = fs::absolute(path).lexically_normal();
    return whole.has_filename() ? whole : whole.parent_path();
}

fs::path common(const fs::path& a, const fs::path& b) {
    fs::path shared;
    for (auto i = a.begin(), j = b.begin(); i != a.end() && j != b.end() && *i == *j; ++i, ++j)
        shared /= *i;
    return shared;
}

bool isUtf8(const std::string& text) {
    try {
        static_cast<void>(nlohmann::json(text).dump());
    } catch (const nlohmann::json::exception&) {
        return false;
    }
    return true;
}

}  // namespace

void PackPlaces::addFoldersLeft(const fs::path& path) {
    fs::path at;
    for (const fs::path& part : fs::absolute(path)) {
        if (part == ".." && at.has_relative_path()) m_folders.insert(plain(at));
        at /= part;
    }
}

void PackPlaces::addFile(const fs::path& file) {
    const fs::path whole = plain(file);
    if (!isUtf8(whole.string()))
        throw HostError(
            ExitCode::kBadInput,
            fmt::format("{}: a pack can't hold a name that is no UTF-8", whole.string()));
    const auto [known, isNew] = m_files.emplace(whole, file);
    std::error_code failed;
    if (!isNew && !fs::equivalent(known->second, file, failed))
        throw HostError(ExitCode::kBadInput,
                        fmt::format("{} and {}: are two files that would be one in a pack",
                                    known->second.string(), file.string()));
    addFoldersLeft(file);
}

void PackPlaces::addSearchPath(const fs::path& folder) {
    m_searchPaths.insert(plain(folder));
    addFoldersLeft(folder);
}

fs::path PackPlaces::base() const {
    fs::path base;
    const auto add = [&base](const fs::path& folder) {
        base = base.empty() ? folder : common(base, folder);
    };
    for (const auto& [whole, file] : m_files) add(whole.parent_path());
    for (const fs::path& folder : m_searchPaths) add(folder);
    for (const fs::path& folder : m_folders) add(folder.parent_path());
    return base;
}

std::string PackPlaces::placeOf(const fs::path& path) const {
    return plain(path).lexically_relative(base()).string();
}

std::map<std::string, fs::path> PackPlaces::files() const {
    std::map<std::string, fs::path> files;
    const fs::path at = base();
    for (const auto& [whole, file] : m_files)
        files.emplace(whole.lexically_relative(at).string(), file);
    return files;
}

std::vector<std::string> PackPlaces::folders() const {
    std::vector<std::string> folders;
    const fs::path at = base();
    for (const fs::path& folder : m_folders) {
        std::string place = folder.lexically_relative(at).string();
        if (place != ".") folders.push_back(std::move(place));
    }
    return folders;
}

}  // namespace pm::host
