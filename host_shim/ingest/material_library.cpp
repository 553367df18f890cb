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

void warnOfMissing(const std::vector<std::string>& names, const std::string& fileName,
                   const WarningSink& warn) {
    constexpr std::size_t kShown = 8;
    std::string list;
    for (std::size_t i = 0; i < std::min(names.size(), kShown); ++i) {
        list += fmt::format("{}'{}'", i == 0 ? "" : ", ", names[i]);
    }
    if (names.size() > kShown) list += fmt::format(" and {} more", names.size() - kShown);
    warn(Warning::kMaterialName,
         fmt::format("{}: in no library, so a grey of 0.8 is taken: material {}", fileName, list));
}

}  // namespace

MaterialLibrary loadMaterials(const ObjText& text, const std::string& fileName,
                              const fs::path& folder, const WarningSink& warn) {
    MaterialLibrary library;
    std::map<std::string, MaterialData> found;
    std::set<std::string> used;
    for (const std::string& name : text.materialNames) {
        used.insert(name);
        used.emplace(withoutComment(name));
    }
    for (const std::string& argument : text.materialFiles) {
        for (const fs::path& file : libraryFiles(argument, folder)) {
            try {
                found.merge(readMaterials(readWholeFile(file), file.string(), file.parent_path(),
                                          warn, &used));
                library.files.push_back(file.string());
            } catch (const HostError& error) {
                warn(Warning::kMaterialFile,
                     fmt::format("{}: material library missing: {}", fileName, error.what()));
            }
        }
    }
    std::vector<std::string> missing;
    for (const std::string& name : text.materialNames) {
        auto material = found.find(name);
        if (material == found.end()) material = found.find(std::string(withoutComment(name)));
        if (material == found.end()) missing.push_back(name);
        library.materials.push_back(material != found.end() ? material->second
                                                            : defaultMaterial(name));
    }
    if (!missing.empty()) warnOfMissing(missing, fileName, warn);
    library.materials.push_back(defaultMaterial("default"));
    return library;
}

}  // namespace pm::host
