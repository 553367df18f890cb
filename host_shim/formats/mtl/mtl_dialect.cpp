// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/mtl/mtl_dialect.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "host_shim/formats/mtl/mtl_keys.h"
#include "host_shim/formats/text_lines.h"
#include "host_shim/values/letter_case.h"

namespace pm::host {
namespace {

using enum MtlDialect;

constexpr std::array<DialectName, 11> kNames{{
    {"generic", kGeneric, "no program that is known"},
    {"blender2.7", kBlender27, "Blender up to 2.79"},
    {"blender2.8", kBlender28, "Blender 2.80 to 3.1"},
    {"blender3", kBlender3, "Blender 3.2 to 3.6"},
    {"blender4", kBlender4, "Blender 4.0 and later"},
    {"3dsmax", k3dsMax, "3ds Max"},
    {"maya", kMaya, "Maya"},
    {"rhino", kRhino, "Rhino"},
    {"sketchup", kSketchUp, "SketchUp"},
    {"zbrush", kZBrush, "ZBrush"},
    {"mcguire", kMcGuire, "McGuire's Computer Graphics Archive"},
}};

// A text that the comments of a program's files hold, in lower case.
struct Sign {
    std::string_view text;
    bool isBeginning;  // the comment begins with it
    MtlDialect dialect;
};
constexpr std::array<Sign, 13> kSigns{{
    {"blender ", true, kBlender28},
    {"www.blender.org", true, kBlender28},
    {"3ds max", false, k3dsMax},
    {"guruware", false, k3dsMax},
    {"max2obj", true, k3dsMax},
    {"as units for non-parametric coordinates", false, kMaya},
    {"the units used in this file are", true, kMaya},
    {"maya", true, kMaya},
    {"rhino", true, kRhino},
    {"exported from sketchup", false, kSketchUp},
    {"zbrush", false, kZBrush},
    {"morgan mcguire", false, kMcGuire},
    {"graphics.cs.williams.edu", false, kMcGuire},
}};

// "v2.73 (sub 0)" and "3.4.1 MTL File" begin with a version: in hundreds, 273 and 304.
std::optional<int> versionAtBegin(std::string_view text) {
    if (text.starts_with('v')) text.remove_prefix(1);
    const auto digits = [&text] {
        const auto end = std::min(text.find_first_not_of("0123456789"), text.size());
        std::int64_t value = -1;
        parseInteger(text.substr(0, end), value);
        text.remove_prefix(end);
        return value;
    };
    const std::int64_t major = digits();
    if (major < 0 || major > 99 || !text.starts_with('.')) return std::nullopt;
    text.remove_prefix(1);
    const std::int64_t minor = digits();
    if (minor < 0 || minor > 99) return std::nullopt;
    return static_cast<int>(major * 100 + minor);
}

DialectChoice blenderOfVersion(int version, const std::string& fileName) {
    const MtlDialect dialect = version < 280   ? kBlender27
                               : version < 302 ? kBlender28
                               : version < 400 ? kBlender3
                                               : kBlender4;
    return {
        dialect,
        fmt::format("the header of {} says Blender {}.{}", fileName, version / 100, version % 100),
        false};
}

std::optional<DialectChoice> dialectOfComment(const std::string& comment,
                                              const std::string& fileName) {
    constexpr std::string_view kBlender = "blender ";
    for (const Sign& sign : kSigns) {
        const auto at = comment.find(sign.text);
        if (at == comment.npos || (sign.isBeginning && at != 0)) continue;
        if (sign.text == kBlender) {
            const auto version = versionAtBegin(std::string_view(comment).substr(kBlender.size()));
            if (version) return blenderOfVersion(*version, fileName);
        }
        const bool isVague = sign.dialect == kBlender28;
        return DialectChoice{
            sign.dialect,
            isVague
                ? fmt::format("the header of {} says Blender, without a version", fileName)
                : fmt::format("the header of {} says {}", fileName, nameOf(sign.dialect).writer),
            isVague};
    }
    return std::nullopt;
}

}  // namespace

std::span<const DialectName> dialectNames() {
    return kNames;
}

const DialectName& nameOf(MtlDialect dialect) {
    return *std::ranges::find(kNames, dialect, &DialectName::dialect);
}

std::optional<MtlDialect> dialectByName(std::string_view name) {
    for (const DialectName& entry : kNames)
        if (equalInAnyCase(name, entry.name)) return entry.dialect;
    return std::nullopt;
}

std::string allDialectNames() {
    std::string names;
    for (const DialectName& entry : kNames)
        names += (names.empty() ? "" : ", ") + std::string(entry.name);
    return names;
}

std::optional<DialectChoice> dialectOfHeader(std::string_view text, const std::string& fileName) {
    // Headers are short; a whole file of comments need not be looked through.
    constexpr std::size_t kLongestHeader = 4096;
    text = text.substr(0, kLongestHeader);
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    std::optional<DialectChoice> choice;
    while (!text.empty()) {
        const auto end = std::min(text.find_first_of("\r\n"), text.size());
        std::string_view line = trimmed(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        if (line.empty()) continue;
        if (!line.starts_with('#')) {
            // Libraries and names of groups stand between comments; numbers end the header.
            if (line.starts_with("mtllib") || line.starts_with("o ") || line.starts_with("g "))
                continue;
            break;
        }
        line.remove_prefix(std::min(line.find_first_not_of("# \t"), line.size()));
        auto found = dialectOfComment(lowerCase(line), fileName);
        if (found && (!choice || choice->isVague)) choice = std::move(found);
        if (choice && !choice->isVague) break;
    }
    return choice;
}

}  // namespace pm::host
