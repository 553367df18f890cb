// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

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

// What the text of an OBJ file says beside its numbers.
struct ObjText {
    std::vector<std::string> materialNames;        // what the NUMBERs of usemtl stand for
    std::vector<std::uint64_t> materialLines;      // where each of them stands first
    std::vector<std::string> materialFiles;        // arguments of mtllib, as they stand
    std::vector<std::uint64_t> materialFileLines;  // where each of them stands first
    std::vector<std::uint64_t> faceLines;          // for each face that is kept
    std::vector<std::uint32_t> faceSizes;          // the parser's own counts end at 255
    std::vector<SubdivisionTag> tags;
    std::array<std::uint64_t, 3> counts{};  // of v, vt, vn
};

// Checks the text of an OBJ file and rewrites it for the parser, a piece at a time. tinyobjloader
// takes bad data without a word, knows no lines afterwards and ends names at a blank.
// One thread at a time.
class ObjTextScan {
  public:
    // Both have to outlive it.
    ObjTextScan(std::string_view text, const std::string& fileName);
    ~ObjTextScan();
    ObjTextScan(const ObjTextScan&) = delete;
    ObjTextScan& operator=(const ObjTextScan&) = delete;

    // Whole lines of v, vn, vt, f, g, usemtl NUMBER and, before the first use of each number,
    // mtllib NUMBER; some 512 KiB of them; empty at the end.
    // Errors: kBadInput, beginning "FILE:LINE: ", for a vertex that is not finite or lacks numbers,
    // a face corner that is not v, v/vt, v//vn or v/vt/vn, and an index that is 0 or counts back
    // too far.
    std::string nextPiece();

    // After the last piece.
    // Errors: kBadInput for an index that is out of range, and "FILE: no geometry" where there is
    // none.
    ObjText finish(const WarningSink& warn);

  private:
    class Scan;
    std::unique_ptr<Scan> m_scan;
};

}  // namespace pm::host
