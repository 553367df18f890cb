// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/ingest/material_library.h"

#include "host_shim/ingest/file_names.h"
#include "host_shim/ingest/materials.h"
#include "host_shim/ingest/obj_reader.h"
#include "host_shim/ingest/text_lines.h"
#include "host_shim/pictures/host_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace pm::host {
namespace {

namespace fs = std::filesystem;

// A word in which a blank may stand behind a backslash.
std::string takeEscapedWord(std::string_view& rest) {
    std::string word(takeWord(rest));
    while (word.ends_with('\\') && !rest.empty()) {
        word.back() = ' ';
        word += takeWord(rest);
    }
    return word;
}

// The files that one mtllib line means: the whole of it when there is such a file (names may hold
// blanks), else each of its words.
std::vector<fs::path> libraryFiles(std::string_view argument, const fs::path& folder) {
    if (const auto whole = findFile(folder, argument)) return {*whole};
    std::vector<fs::path> files;
    for (std::string_view rest = withoutComment(argument); !rest.empty();) {
        const std::string word = takeEscapedWord(rest);
        files.push_back(findFile(folder, word).value_or(folder / word));
    }
    return files;
}

// missing: places in the list of names, in the order of the file.
void warnOfMissing(const ObjText& text, const std::vector<std::size_t>& missing,
                   const std::string& fileName, const WarningSink& warn) {
    constexpr std::size_t kShown = 8;
    std::string list;
    std::size_t count = 0;
    std::uint64_t firstLine = 0;
    for (const std::size_t i : missing) {
        const std::string& name = text.materialNames[i];
        if (name.empty()) {
            warn(Warning::kMaterialName,
                 fmt::format("{}:{}: usemtl without a name, so a grey of 0.8 is taken", fileName,
                             text.materialLines[i]));
            continue;
        }
        if (count == 0) firstLine = text.materialLines[i];
        if (count++ < kShown) list += fmt::format("{}'{}'", list.empty() ? "" : ", ", name);
    }
    if (count == 0) return;
    if (count > kShown) list += fmt::format(" and {} more", count - kShown);
    warn(Warning::kMaterialName,
         fmt::format("{}:{}: in no library, so a grey of 0.8 is taken: material {}", fileName,
                     firstLine, list));
}

// The names of usemtl lines. A comment may follow there or in the library, or what looks like one
// is part of the name: so a name counts as it stands, else without its comment, else for one of the
// library that has a comment.
class NamesInUse {
  public:
    explicit NamesInUse(const std::vector<std::string>& names) {
        for (const std::string& name : names) {
            m_names.insert(name);
            m_bareNames.emplace(withoutComment(name));
        }
    }

    bool has(const std::string& inLibrary) const {
        return m_names.contains(inLibrary) || m_bareNames.contains(inLibrary) ||
               m_names.contains(std::string(withoutComment(inLibrary)));
    }

  private:
    std::set<std::string> m_names, m_bareNames;
};

using Materials = std::map<std::string, MaterialData>;

const MaterialData* materialIn(const Materials& materials, const std::string& name) {
    const auto found = materials.find(name);
    return found != materials.end() ? &found->second : nullptr;
}

Materials withBareNames(const Materials& materials) {
    Materials bare;
    for (const auto& [name, material] : materials) bare.emplace(withoutComment(name), material);
    return bare;
}

}  // namespace

MaterialLibrary loadMaterials(const ObjText& text, const std::string& fileName,
                              const fs::path& folder, const WarningSink& warn) {
    MaterialLibrary library;
    Materials found;
    const NamesInUse names(text.materialNames);
    const auto isUsed = [&names](const std::string& name) { return names.has(name); };
    for (std::size_t i = 0; i < text.materialFiles.size(); ++i) {
        for (const fs::path& file : libraryFiles(text.materialFiles[i], folder)) {
            try {
                found.merge(readMaterials(readWholeFile(file), file.string(), file.parent_path(),
                                          warn, isUsed));
                library.files.push_back(file.string());
            } catch (const HostError& error) {
                warn(Warning::kMaterialFile,
                     fmt::format("{}:{}: material library missing: {}; a grey of 0.8 is taken for "
                                 "materials that no other library has",
                                 fileName, text.materialFileLines[i], error.what()));
            }
        }
    }
    const Materials bare = withBareNames(found);
    std::vector<std::size_t> missing;
    for (const std::string& name : text.materialNames) {
        const MaterialData* material = materialIn(found, name);
        if (material == nullptr) material = materialIn(found, std::string(withoutComment(name)));
        if (material == nullptr) material = materialIn(bare, name);
        if (material == nullptr) missing.push_back(library.materials.size());
        library.materials.push_back(material != nullptr ? *material : defaultMaterial(name));
    }
    warnOfMissing(text, missing, fileName, warn);
    library.materials.push_back(defaultMaterial("default"));
    return library;
}

}  // namespace pm::host
