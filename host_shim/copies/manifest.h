// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pm::host {

// A file of a packed scene. Its place is a path below the pack's folder: parts divided by '/', none
// of them empty, "." or "..".
struct PackedFile {
    std::string place;
    std::uint64_t bytes{};
    std::string sha256;
};

// A file that an option names, --ocio or --environment.
struct PackedOption {
    std::string text;  // as it was typed; empty where a variable gave it
    std::string place;
};

// What a packed scene is made of: FOLDER/manifest.json. The contents lie beside it, by their
// hashes: objectPath().
struct Manifest {
    std::string scene;                     // its place
    std::string base;                      // the folder that all places were below, absolute
    std::vector<std::string> folders;      // places that are there though nothing lies in them
    std::vector<std::string> searchPaths;  // places; "." is the pack's folder
    std::optional<PackedOption> ocio, environment;
    std::vector<PackedFile> files;  // ordered by place, each once

    std::uint64_t bytes() const;  // of all contents, those that are alike once; at most 2^60

    // Of toJson(), white space left out.
    static std::string beginning();
    std::string toJson() const;
    // memoryLimit: what --memory-limit leaves, in bytes; 0: nothing was said. where: for messages.
    // Errors: kBadInput for anything else than toJson() gives; those of JsonBudget; Interrupted.
    static Manifest fromJson(std::string_view text, const std::string& where,
                             std::uint64_t memoryLimit = 0);
};

// "objects/ab/ab12..." of a hash.
std::string objectPath(const std::string& sha256);

// Whether a text is a place, as PackedFile has it.
bool isPlace(std::string_view text);

}  // namespace pm::host
