// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "host_shim/colour/picture_statement.h"
#include "host_shim/textures/texture_facts.h"
#include "host_shim/textures/texture_index.h"

namespace pm::host {

// What an original's header says, kept so that it need not be opened again.
struct Original {
    std::string content;  // hash of its bytes
    bool isFloatFile{};
    PictureStatement statement;
    std::uint64_t bytes{};  // that making a texture of it takes
    std::string size;       // "W x H"
};

// What a cache keeps of a picture and of the texture made of it. stamp: of `file` when it was read.
Record toRecord(const Original& original, const FileStamp& stamp,
                const std::filesystem::path& file);
Original toOriginal(const Record& record);
Record toRecord(const TextureFacts& facts, const std::filesystem::path& file);
TextureFacts toFacts(const Record& record);

}  // namespace pm::host
