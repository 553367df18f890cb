// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/ingest/mtl_text.h"

#include "host_shim/ingest/text_lines.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pm::host {
namespace {

constexpr std::array<std::string_view, 6> kColours{"Ka", "Kd", "Ks", "Ke", "Kt", "Tf"};
constexpr std::array<std::string_view, 9> kNumbers{"Ns", "Ni", "d",  "Tr", "illum",
                                                   "Pr", "Pm", "Ps", "Pc"};

// Under one name each; what is not rendered is told by that name (materials.cpp).
constexpr std::array<std::string_view, 17> kMaps{
    "map_Ka", "map_Kd", "map_Ks", "map_Ns", "map_d",    "map_Ke",   "map_Pr",   "map_Pm",  "map_Ps",
    "bump",   "disp",   "norm",   "refl",   "map_bump", "map_Bump", "map_disp", "map_Disp"};

std::string_view usualName(std::string_view map) {
    if (map == "map_opacity" || map == "map_D") return "map_d";
    return map == "map_Kt" ? "map_Tf" : map;
}

// Of no weight here, or told by its number (materials.cpp): known, but not for the parser.
constexpr std::array<std::string_view, 6> kNotRead{"sharpness", "aniso", "anisor",
                                                   "Pcr",       "decal", "map_aat"};

bool isMap(std::string_view word) {
    return std::ranges::find(kMaps, word) != kMaps.end();
}

// How many numbers the parser takes after an option of a map line; 0 for options with a word.
std::size_t optionNumbers(std::string_view option) {
    if (option == "-o" || option == "-s" || option == "-t") return 3;
    if (option == "-mm") return 2;
    return 0;
}

// Pads the numbers after -o, -s, -t and -mm to as many as the parser takes.
std::string cleanedMapLine(std::string_view rest) {
    std::string out;
    while (rest.starts_with('-')) {
        const std::string_view option = takeWord(rest);
        const std::size_t wanted = optionNumbers(option);
        out.append(option).append(" ");
        if (wanted == 0) {
            out.append(takeWord(rest)).append(" ");
            continue;
        }
        std::vector<std::string> numbers;
        while (numbers.size() < wanted) {
            std::string_view ahead = rest;
            const std::string_view word = takeWord(ahead);
            double value = 0;
            if (!parseNumber(word, value)) break;
            numbers.emplace_back(word);
            rest = ahead;
        }
        // -s u means u 1 1; -o u means u 0 0; -mm base means base 1.
        const char* missing = option == "-s" || option == "-mm" ? "1" : "0";
        numbers.resize(wanted, missing);
        for (const std::string& number : numbers) out.append(number).append(" ");
    }
    return out.append(rest);
}

void addNumbers(std::string_view word, std::string_view rest, std::size_t wanted,
                MtlSection& section) {
    const std::string whole(rest);
    std::vector<std::string> numbers;
    bool finite = true;
    while (numbers.size() < wanted && !rest.empty() && !rest.starts_with('#')) {
        const std::string_view number = takeWord(rest);
        double value = 0;
        if (!parseNumber(number, value) || !std::isfinite(value)) finite = false;
        numbers.emplace_back(number);
    }
    // A colour of one number is grey; of two, two channels are anybody's guess.
    if (!finite || (numbers.size() != 1 && numbers.size() != wanted)) {
        section.notUnderstood.insert_or_assign(std::string(word), whole);
        return;
    }
    numbers.resize(wanted, numbers.front());
    section.cleaned.append(word);
    for (const std::string& number : numbers) section.cleaned.append(" ").append(number);
    section.cleaned.append("\n");
}

void addStatement(std::string_view line, std::uint64_t number, MtlSection& section) {
    std::string_view rest = line;
    const std::string_view word = usualName(takeWord(rest));
    section.lines.insert_or_assign(std::string(word), number);
    // -halo is an option of d that few write: the share still follows.
    if (word == "d" && rest.starts_with("-halo")) takeWord(rest);
    if (std::ranges::find(kColours, word) != kColours.end()) {
        addNumbers(word, rest, 3, section);
    } else if (std::ranges::find(kNumbers, word) != kNumbers.end()) {
        addNumbers(word, rest, 1, section);
    } else if (word == "map_Tf") {
        // Under a name that the parser knows, in a section of its own.
        section.transmissionMap = "newmtl t\nmap_Kd " + cleanedMapLine(rest) + "\n";
    } else if (isMap(word)) {
        section.cleaned.append(word).append(" ").append(cleanedMapLine(rest)).append("\n");
    } else if (std::ranges::find(kNotRead, word) == kNotRead.end()) {
        section.notUnderstood.insert_or_assign(std::string(word), std::string(rest));
    }
}

}  // namespace

std::vector<MtlSection> readMtlText(std::string_view text) {
    std::vector<MtlSection> sections;
    TextLines lines(text);
    while (lines.next()) {
        std::string_view rest = lines.line();
        if (takeWord(rest) == "newmtl") {
            MtlSection& section = sections.emplace_back();
            section.name = rest;
            section.cleaned = "newmtl m\n";
            section.lines["newmtl"] = lines.number();
        } else if (!sections.empty()) {
            addStatement(lines.line(), lines.number(), sections.back());
        }
    }
    return sections;
}

}  // namespace pm::host
