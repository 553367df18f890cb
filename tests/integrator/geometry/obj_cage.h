// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Reads the little of Wavefront OBJ that the tests' cages are written in, with the subdivision tags
// of OpenSubdiv's regression shapes (t crease, corner, hole, interpolateboundary and so on).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "integrator/geometry/subdivision.h"

namespace pm::test {

SubdivisionCage parseObjCage(std::string_view text);

// An empty cage when there is no such file. The scheme comes from the file's name (loop_,
// bilinear_).
SubdivisionCage readObjCage(const std::filesystem::path& path);

// The .obj files of a folder in the order of their names; none when the folder is absent.
std::vector<std::filesystem::path> objFiles(const std::filesystem::path& folder);

// A cube of +-1 with its faces outwards, no texture coordinates.
SubdivisionCage cubeCage();

// A grid of quads in the plane z = 0, `side` x `side` faces of size 1 from the origin.
SubdivisionCage gridCage(int side);

}  // namespace pm::test
