// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/copies/pack_check.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "host_shim/copies/copied_options.h"
#include "host_shim/formats/scene_reader.h"
#include "host_shim/session/read_rules.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

// Removed with this.
class LinkTree {
  public:
    LinkTree(const Manifest& manifest, const fs::path& folder)
        : m_root(newFolder(fs::absolute(folder))) {
        try {
            for (const std::string& place : manifest.folders) makeFolder(m_root / place);
            for (const std::string& place : manifest.searchPaths) makeFolder(m_root / place);
            for (const PackedFile& file : manifest.files)
                put(folder / objectPath(file.sha256), m_root / file.place);
        } catch (...) {
            remove();
            throw;
        }
    }
    ~LinkTree() { remove(); }
    LinkTree(const LinkTree&) = delete;
    LinkTree& operator=(const LinkTree&) = delete;
    const fs::path& root() const { return m_root; }

  private:
    // Under a name that nothing has.
    static fs::path newFolder(const fs::path& folder) {
        std::string name = (folder / "check.tmp.XXXXXX").string();
        if (::mkdtemp(name.data()) == nullptr)
            throw HostError(ExitCode::kFile, fmt::format("{}: no folder can be made there: {}",
                                                         folder.string(), std::strerror(errno)));
        return name;
    }
    static void makeFolder(const fs::path& folder) {
        std::error_code failed;
        fs::create_directories(folder, failed);
        if (failed)
            throw HostError(ExitCode::kFile, fmt::format("{}: can't be made: {}", folder.string(),
                                                         failed.message()));
    }
    // A server's file system may have no hard links.
    static void put(const fs::path& object, const fs::path& place) {
        makeFolder(place.parent_path());
        std::error_code failed;
        fs::create_hard_link(object, place, failed);
        if (failed) fs::copy_file(object, place, failed);
        if (failed)
            throw HostError(ExitCode::kFile, fmt::format("{}: can't be written: {}", place.string(),
                                                         failed.message()));
    }
    void remove() const {
        std::error_code ignored;
        fs::remove_all(m_root, ignored);
    }

    fs::path m_root;
};

}  // namespace

std::vector<std::string> placesRead(const Options& options, const fs::path& tree) {
    const SceneData scene = readScene(options, [](Warning, const std::string&) {}, {});
    const fs::path root = fs::canonical(tree);
    std::vector<std::string> places;
    std::error_code failed;
    for (const fs::path& file : filesOf(scene)) {
        const fs::path real = fs::canonical(file, failed);
        if (!failed) places.push_back(real.lexically_relative(root).string());
    }
    return places;
}

void checkReadsTheSame(const Manifest& manifest, const fs::path& folder, const Options& options,
                       const std::vector<std::string>& expected) {
    const LinkTree tree(manifest, folder);
    Options copied = options;
    nameCopies(manifest, tree.root(), copied);
    const std::vector<std::string> read = placesRead(copied, tree.root());
    const auto [wanted, found] = std::ranges::mismatch(expected, read);
    if (wanted == expected.end() && found == read.end()) return;
    const auto name = [&manifest](auto place, auto end) {
        return place == end ? std::string("none")
                            : (fs::path(manifest.base) / *place).lexically_normal().string();
    };
    throw HostError(
        ExitCode::kBadInput,
        fmt::format("pack: where the scene reads {}, its copies would lead to {}; give the scene a "
                    "plain relative path to it",
                    name(wanted, expected.end()), name(found, read.end())));
}

}  // namespace pm::host
