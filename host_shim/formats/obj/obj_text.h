// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host_shim/formats/scene_data.h"
#include "host_shim/formats/warnings.h"

namespace pm::host {

// A `t` statement: OpenSubdiv's tags. Vertices and faces in it count from 0 through the whole file.
struct SubdivisionTag {
    std::string name;
    std::vector<std::int64_t> integers;
    std::vector<double> reals;
    std::string text;
    std::uint64_t line{};
    std::uint64_t group{};  // the group it stands in, of those with faces
};

// What the text of an OBJ file says beside its numbers, and the text that is left for the parser.
// tinyobjloader takes bad data without a word, knows no lines afterwards and ends names at a blank;
// so the text is checked first, and rewritten where the parser would stumble.
struct ObjText {
    std::string cleaned;                           // only v, vn, vt, f, g and usemtl NUMBER
    std::vector<std::string> materialNames;        // what the NUMBERs of usemtl stand for
    std::vector<std::uint64_t> materialLines;      // where each of them stands first
    std::vector<std::string> materialFiles;        // arguments of mtllib, as they stand
    std::vector<std::uint64_t> materialFileLines;  // where each of them stands first
    std::vector<std::uint64_t> faceLines;          // for each face that is kept
    std::vector<std::uint32_t> faceSizes;          // the parser's own counts end at 255
    std::vector<SubdivisionTag> tags;
    std::array<std::uint64_t, 3> counts{};  // of v, vt, vn
};

// Checks and rewrites the text of an OBJ file.
// Errors: kBadInput, beginning "FILE:LINE: ", for a vertex that is not finite or lacks numbers, a
// face corner that is not v, v/vt, v//vn or v/vt/vn, and an index that is 0 or out of range; and
// "FILE: no geometry" where there is none; what goOn throws.
ObjText readObjText(std::string_view text, const std::string& fileName, const WarningSink& warn,
                    const GoOn& goOn = {});

}  // namespace pm::host
