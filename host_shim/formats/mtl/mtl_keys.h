// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>
#include <string_view>

namespace pm::host {

// What stands behind a key of an MTL file.
enum class MtlKind {
    kColour,         // one or three numbers
    kNumber,         // one number
    kMap,            // options and the name of a picture; rendered
    kMapLeftOut,     // the same, not rendered yet
    kMapOfNumber,    // the same, of what is rendered by one number
    kNumberLeftOut,  // a number that is not rendered yet; 0 changes nothing
    kNoWeight,       // says nothing to a renderer like this one
};

// A key of MTL files. Keys may be written in any case.
struct MtlKey {
    const char* key;
    const char* meansKey;  // the key under which it is kept: several write one thing in other words
    MtlKind kind;
};

// All that are understood; docs/obj_mtl.md has a row for each.
std::span<const MtlKey> mtlKeys();
// Null where there is none.
const MtlKey* findMtlKey(std::string_view word);

enum class MapOptionKind { kNumbers, kOnOff, kWord };

// An option of a map line, with its dash.
struct MapOption {
    const char* option;
    MapOptionKind kind;
    std::size_t numbers;   // at most
    double missingNumber;  // what those mean that are not written, but for the first
    bool isRendered;       // else left out, with a warning where it asks for something
};

// All that are understood; docs/obj_mtl.md has a row for each.
std::span<const MapOption> mapOptions();
const MapOption* findMapOption(std::string_view word);

}  // namespace pm::host
