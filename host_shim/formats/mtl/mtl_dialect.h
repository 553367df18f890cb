// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host_shim/formats/mtl/mtl_text.h"

namespace pm::host {

// What wrote an MTL file; the same keys mean other things in each. docs/obj_mtl.md has the table.
enum class MtlDialect {
    kGeneric,    // as the keys are described, for files that nobody says anything about
    kBlender27,  // Blender up to 2.79, with its own renderer's materials
    kBlender28,  // Blender 2.80 to 3.1, by the exporter in Python
    kBlender3,   // Blender 3.2 to 3.6
    kBlender4,   // Blender 4.0 and later
    k3dsMax,
    kMaya,
    kRhino,
    kSketchUp,
    kZBrush,
    kMcGuire,  // McGuire's Computer Graphics Archive
};

struct DialectName {
    const char* name;  // of --mtl-dialect
    MtlDialect dialect;
    const char* writer;  // the program, for people
};
std::span<const DialectName> dialectNames();
const DialectName& nameOf(MtlDialect dialect);
// None for a name that is none. In any case of letters.
std::optional<MtlDialect> dialectByName(std::string_view name);
// "blender, blender4, ...", for messages.
std::string allDialectNames();

// Which dialect was taken for a file, and why.
struct DialectChoice {
    MtlDialect dialect{MtlDialect::kGeneric};
    std::string reason;
    bool isVague{};  // the program is known, its version isn't
};

// By the comments before the first statements of an OBJ or MTL text; none where they name no
// program that is known. fileName is for the reason.
std::optional<DialectChoice> dialectOfHeader(std::string_view text, const std::string& fileName);

// Whether what has Ke shines from both sides there, not from the front alone.
bool emitsFromBothSides(MtlDialect dialect);

// Whether a number beside its picture says nothing: exporters write what the picture replaces.
bool picturesStandAlone(MtlDialect dialect);

// Something to tell about what was translated: the key whose line to show, and the text.
struct DialectNote {
    std::string key;
    std::string text;
};

struct Translation {
    std::vector<DialectNote> notes;
    std::array<double, 3> sheenTint{1, 1, 1};  // of Ps
    double sheenRoughness{0.3};
    double diffuseGain{1};  // that the picture of Kd is multiplied by
};

// A picture of what is metal, and what multiplies it.
struct MetalMap {
    std::string key;
    double factor{1};
};
// None where the section's program or kind of surface has none.
std::optional<MetalMap> metalMapOf(MtlDialect dialect, const MtlSection& section);

// Turns what a section says in its dialect into what the keys mean in the generic one. Nothing is
// changed for kGeneric.
Translation translateToGeneric(MtlDialect dialect, MtlSection& section);

}  // namespace pm::host
