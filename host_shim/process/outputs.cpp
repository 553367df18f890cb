// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/process/outputs.h"

#include <fmt/format.h>

#include <set>
#include <string_view>
#include <vector>

#include "host_shim/pictures/picture_io.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

// The same text for the same file, whether it exists or not.
fs::path identity(const fs::path& path) {
    std::error_code error;
    const fs::path known = fs::weakly_canonical(fs::absolute(path), error);
    return error ? path : known;
}

void makeFolder(const fs::path& file) {
    const fs::path folder = fs::absolute(file).parent_path();
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) {
        throw HostError(ExitCode::kFile, fmt::format("{}: the folder can't be made: {}",
                                                     folder.string(), error.message()));
    }
}

// Inputs are not all known before the scene is read, so a slip of the keyboard such as
// `--log box.mtl` is caught by the name.
void checkTextName(const fs::path& file) {
    std::vector<std::string_view> taken = pictureEndings();
    taken.insert(taken.end(),
                 {".obj", ".mtl", ".pov", ".inc", ".ocio", ".tga", ".hdr", ".bmp", ".tx"});
    for (const std::string_view extension : taken) {
        if (lowerCaseExtension(identity(file)) != extension) continue;
        throw HostError(
            ExitCode::kUsage,
            fmt::format("{}: statistics, logs, reports, parts, checkpoints and photon maps may not "
                        "end in {}, "
                        "like an input or a picture; .json, .log or .pmcheck would do",
                        file.string(), extension));
    }
}

void checkTextFile(const fs::path& file) {
    std::error_code error;
    const fs::path folder = fs::absolute(file).parent_path();
    if (!fs::is_directory(folder, error)) {
        throw HostError(
            ExitCode::kFile,
            fmt::format("{}: the folder {} does not exist (--make-output-path makes it)",
                        file.string(), folder.string()));
    }
    if (fs::exists(file, error) && !fs::is_regular_file(file, error)) {
        throw HostError(ExitCode::kFile,
                        fmt::format("{}: can't be written: it is no regular file", file.string()));
    }
    const FinishedFile probe(file);
}

}  // namespace

void checkOutputs(const std::vector<fs::path>& pictures, const std::vector<fs::path>& others,
                  bool makeFolders) {
    // All that needs no disk first, so that a typing error leaves no folders behind.
    std::set<fs::path> seen;
    for (const fs::path& picture : pictures) pictureFormat(picture);
    for (const fs::path& file : others) checkTextName(file);
    for (const auto* files : {&pictures, &others}) {
        for (const fs::path& file : *files) {
            if (!seen.insert(identity(file)).second) {
                throw HostError(ExitCode::kUsage,
                                fmt::format("{}: this output is named twice", file.string()));
            }
        }
    }
    for (const auto* files : {&pictures, &others}) {
        for (const fs::path& file : *files) {
            if (makeFolders) makeFolder(file);
            if (files == &pictures) {
                checkWritable(file);
            } else {
                checkTextFile(file);
            }
        }
    }
}

void checkNotInputs(const std::vector<fs::path>& outputs, const std::vector<fs::path>& inputs) {
    std::set<fs::path> files;
    for (const fs::path& input : inputs) files.insert(identity(input));
    for (const fs::path& output : outputs) {
        if (files.contains(identity(output))) {
            throw HostError(ExitCode::kUsage,
                            fmt::format("{}: this output is also an input", output.string()));
        }
    }
}

}  // namespace pm::host
