// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "host_shim/formats/scene_reader.h"

namespace pm::host {

// All kinds of scene files. They live as long as the program.
std::span<const SceneReader* const> sceneReaders();

// The reader for a file, by the end of its name in any case of letters.
// Errors: kBadInput with the ends that are allowed.
const SceneReader& sceneReaderFor(const std::filesystem::path& file);

// "an OBJ file", or all kinds with "or" between them.
std::string sceneKinds();

}  // namespace pm::host
