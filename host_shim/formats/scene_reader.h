// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host_shim/formats/scene_data.h"
#include "host_shim/formats/scene_files.h"
#include "host_shim/formats/warnings.h"

namespace pm::host {

// Of scenes in POV-Ray's language.
struct PovRules {
    std::string library;  // the folder of its own include files; empty: where Debian puts it
    bool mayWrite{};      // #fopen ... write makes files
    std::optional<std::int64_t> frame;                 // of an animation; none: its first
    std::function<void(const std::string& text)> say;  // hears what #debug says; may be empty
};

// How a scene is read, and from which files.
struct ReadRules {
    std::string mtlDialect;  // of all MTL files, as --mtl-dialect names it; empty: by their headers
    SceneFileRules files;
    std::vector<std::string> materials;  // names that are wanted beside those that faces use
    MemoryNote takes{};                  // beside what the scene's own file takes by its size
    std::uint32_t threads{1};            // that reading may keep busy; 0: as many as there are
    std::array<std::int32_t, 2> size{640, 480};  // of the picture, pixels
    PovRules pov{};
};

// What a reader is given.
struct ReadRequest {
    std::filesystem::path file;
    const WarningSink& warn;
    const GoOn& goOn;  // called again and again; what it throws ends the reading; may be empty
    std::optional<std::array<double, 3>> eye;  // the camera's place, if it is known; see centreFor
    const ReadRules& rules;
};

// A kind of scene file. scene_readers.cpp has the list of them. Immutable: any thread.
class SceneReader {
  public:
    virtual ~SceneReader() = default;

    // As messages call a file of this kind: "an OBJ file".
    virtual std::string_view name() const = 0;
    // The ends of names that it takes, with their dots, in small letters.
    virtual std::span<const std::string_view> endings() const = 0;
    // Reads a file and what it refers to. Every index of the answer is checked, and each file that
    // was opened on the way is among filesOf it. What can do without is warned of.
    // Errors: kFile when the file can't be read; kBadInput, "FILE:LINE: what", when it is bad.
    virtual SceneData read(const ReadRequest& request) const = 0;
};

// The files that a scene refers to: what was read for it, and pictures that are still to be read.
std::vector<std::filesystem::path> filesOf(const SceneData& scene);

}  // namespace pm::host
