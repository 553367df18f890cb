// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/obj/material_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "host_shim/formats/file_names.h"
#include "host_shim/formats/mtl/material_checks.h"
#include "host_shim/formats/mtl/materials.h"
#include "host_shim/formats/source_file.h"
#include "host_shim/formats/text_lines.h"
#include "host_shim/values/host_error.h"
#include "host_shim/values/letter_case.h"

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

struct LibraryFile {
    fs::path file;
    std::string whyNone;  // empty where it is a file
};

// The files that one mtllib line means: the whole of it when there is such a file (names may hold
// blanks), else each of its words, and where one of them is none, the tail of the whole.
std::vector<LibraryFile> libraryFiles(std::string_view argument, const fs::path& folder,
                                      SceneFiles& files) {
    if (const auto whole = files.findWhole(folder, argument)) return {{*whole, ""}};
    std::vector<LibraryFile> found;
    bool isComplete = true;
    for (std::string_view rest = withoutComment(argument); !rest.empty();) {
        const std::string word = takeEscapedWord(rest);
        const auto file = files.find(folder, word);
        isComplete = isComplete && file;
        if (file)
            found.push_back({*file, ""});
        else
            found.push_back({folder / word, files.whyNone(folder, word)});
    }
    if (isComplete) return found;
    if (const auto tail = files.find(folder, argument)) return {{*tail, ""}};
    return found;
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

// The names of usemtl lines, in any case of letters. A comment may follow there or in the library,
// or what looks like one is part of the name: so a name counts as it stands, else without its
// comment, else for one of the library that has a comment.
class NamesInUse {
  public:
    void add(const std::vector<std::string>& names) {
        for (const std::string& name : names) {
            m_names.insert(lowerCase(name));
            m_bareNames.insert(lowerCase(withoutComment(name)));
        }
    }

    bool has(const std::string& inLibrary) const {
        const std::string lower = lowerCase(inLibrary);
        return m_names.contains(lower) || m_bareNames.contains(lower) ||
               m_names.contains(lowerCase(withoutComment(inLibrary)));
    }

  private:
    std::set<std::string> m_names, m_bareNames;
};

// The materials of all libraries. A name counts as it stands, else without its comment, else with
// letters of the other case.
class Materials {
  public:
    void add(std::map<std::string, MaterialData> more) { m_byName.merge(more); }

    // After the last was added.
    void index() {
        for (const auto& [name, material] : m_byName) {
            m_byBareName.emplace(withoutComment(name), &material);
            m_byLowerName.emplace(lowerCase(name), &material);
            m_byLowerBareName.emplace(lowerCase(withoutComment(name)), &material);
        }
    }

    // Null where there is none.
    const MaterialData* find(const std::string& name) const {
        const std::string bare(withoutComment(name));
        for (const std::string& wanted : {name, bare}) {
            const auto found = m_byName.find(wanted);
            if (found != m_byName.end()) return &found->second;
        }
        for (const auto& [names, wanted] :
             {std::pair{&m_byBareName, name}, std::pair{&m_byLowerName, lowerCase(name)},
              std::pair{&m_byLowerName, lowerCase(bare)},
              std::pair{&m_byLowerBareName, lowerCase(name)}}) {
            const auto found = names->find(wanted);
            if (found != names->end()) return found->second;
        }
        return nullptr;
    }

  private:
    using Index = std::map<std::string, const MaterialData*>;

    std::map<std::string, MaterialData> m_byName;
    Index m_byBareName, m_byLowerName, m_byLowerBareName;
};

DialectChoice dialectFor(std::string_view text, const std::string& file,
                         const LibrarySource& source) {
    if (source.asked) return *source.asked;
    const auto own = dialectOfHeader(text, file);
    if (own && !(own->isVague && source.ofScene)) return *own;
    if (source.ofScene) return *source.ofScene;
    return {MtlDialect::kGeneric, "no header says which program wrote it"};
}

// Reads one library and adds to library what it has. Errors: kFile.
void readLibrary(const LibraryFile& library, const LibrarySource& source, SceneFiles& files,
                 const WarningSink& warn, const NameFilter& isUsed, Materials& materials,
                 std::vector<MaterialFile>& read) {
    std::error_code ignored;
    const fs::path& file = library.file;
    // A folder, a pipe or nothing is told by who reads it. A device may have no end.
    const bool isOfSystem = fs::is_character_file(file, ignored) ||
                            fs::is_block_file(file, ignored) || fs::is_socket(file, ignored);
    if (!library.whyNone.empty() && !files.isTrusted())
        throw HostError(ExitCode::kFile, library.whyNone);
    if (isOfSystem)
        throw HostError(
            ExitCode::kFile,
            fmt::format("{}: can't be read: it is a device; a file is wanted", file.string()));
    const std::string text = readWholeFile(file);
    const DialectChoice choice = dialectFor(text, file.string(), source);
    materials.add(readMaterials(text, {file.string(), file.parent_path(), choice.dialect}, files,
                                warn, isUsed));
    read.push_back({file.string(), nameOf(choice.dialect).name, choice.reason});
}

// What the materials take, and a library's text.
void noteMemory(const ObjText& text, const LibrarySource& source, const fs::path& library) {
    // As it is read, in lists by name and in the answer; measured.
    constexpr std::uint64_t kBytesOfMaterial = 1400;
    if (!source.takes) return;
    std::error_code none;
    const std::uint64_t bytes = fs::file_size(library, none);
    source.takes((text.materialNames.size() + source.alsoWanted.size()) * kBytesOfMaterial +
                 (none ? 0 : bytes));
}

}  // namespace

MaterialLibrary loadMaterials(const ObjText& text, const LibrarySource& source, SceneFiles& files,
                              const WarningSink& warn, const GoOn& goOn) {
    MaterialLibrary library;
    Materials found;
    NamesInUse names;
    names.add(text.materialNames);
    names.add(source.alsoWanted);
    const auto isUsed = [&names](const std::string& name) { return names.has(name); };
    for (std::size_t i = 0; i < text.materialFiles.size(); ++i) {
        if (goOn) goOn();
        for (const LibraryFile& file : libraryFiles(text.materialFiles[i], source.folder, files)) {
            noteMemory(text, source, file.file);
            try {
                readLibrary(file, source, files, warn, isUsed, found, library.files);
            } catch (const HostError& error) {
                warn(Warning::kMaterialFile,
                     fmt::format("{}:{}: material library missing: {}; a grey of 0.8 is taken for "
                                 "materials that no other library has",
                                 source.sceneName, text.materialFileLines[i], error.what()));
            }
        }
    }
    found.index();
    std::vector<std::size_t> missing;
    for (const std::string& name : text.materialNames) {
        const MaterialData* material = found.find(name);
        if (material == nullptr) missing.push_back(library.materials.size());
        library.materials.push_back(material != nullptr ? *material : defaultMaterial(name));
    }
    warnOfMissing(text, missing, source.sceneName, warn);
    const std::set<std::string> used(text.materialNames.begin(), text.materialNames.end());
    for (const std::string& name : source.alsoWanted) {
        const MaterialData* material = used.contains(name) ? nullptr : found.find(name);
        if (material != nullptr) library.materials.push_back(*material);
    }
    warnOfUnlikelyMaterials(library.materials, source.sceneName, warn);
    library.materials.push_back(defaultMaterial("default"));
    return library;
}

}  // namespace pm::host
