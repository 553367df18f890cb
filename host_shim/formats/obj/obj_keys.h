// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>
#include <string_view>

namespace pm::host {

// What a statement of an OBJ file is to the reader.
enum class ObjStatement {
    kVertex,
    kTextureCoordinate,
    kNormal,
    kFace,
    kGroup,
    kMaterial,
    kLibrary,
    kTag,
    kLeftOut,   // of geometry that is not rendered: left out, with a warning
    kNoWeight,  // changes no triangle: smoothing, weights of skins, hints to other programs
    kUnknown,
};

struct ObjKey {
    const char* key;
    ObjStatement statement;
};

// All that are understood; docs/obj_mtl.md has a row for each.
std::span<const ObjKey> objKeys();
ObjStatement statementOf(std::string_view word);

}  // namespace pm::host
