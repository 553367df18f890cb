// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/mtl/map_line.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "host_shim/formats/mtl/mtl_keys.h"
#include "host_shim/formats/text_lines.h"
#include "host_shim/values/letter_case.h"

namespace pm::host {
namespace {

// Up to as many numbers as the option has.
std::vector<double> takeNumbers(std::string_view& rest, std::size_t most) {
    std::vector<double> numbers;
    while (numbers.size() < most) {
        std::string_view ahead = rest;
        const std::string_view word = takeWord(ahead);
        double value = 0;
        if (word.empty() || !parseNumber(word, value) || !std::isfinite(value)) break;
        numbers.push_back(value);
        rest = ahead;
    }
    return numbers;
}

// Of what is not rendered: whether it asks for something all the same.
bool asksForSomething(std::string_view option, const std::vector<double>& numbers,
                      std::string_view word) {
    if (equalInAnyCase(option, "-cc")) return equalInAnyCase(word, "on");
    if (equalInAnyCase(option, "-t") || equalInAnyCase(option, "-boost"))
        return std::ranges::any_of(numbers, [](double number) { return number != 0; });
    if (equalInAnyCase(option, "-blendu") || equalInAnyCase(option, "-blendv"))
        return false;  // how texels are filtered is the renderer's own choice
    return equalInAnyCase(option, "-type");
}

// m is what is taken without it, too.
void takeChannel(std::string_view value, MapLine& line) {
    constexpr std::string_view kChannels = "rgblz";
    const char letter = value.size() == 1
                            ? static_cast<char>(std::tolower(static_cast<unsigned char>(value[0])))
                            : '\0';
    if (letter == 'm') return;
    if (letter != '\0' && kChannels.find(letter) != kChannels.npos)
        line.channel = letter;
    else
        line.leftOut.emplace_back("-imfchan");
}

void setNumbers(std::string_view option, const std::vector<double>& numbers, MapLine& line) {
    if (equalInAnyCase(option, "-s")) std::ranges::copy(numbers, line.scale.begin());
    if (equalInAnyCase(option, "-o")) std::ranges::copy(numbers, line.offset.begin());
    if (equalInAnyCase(option, "-bm")) line.strength = numbers[0];
    if (!equalInAnyCase(option, "-mm")) return;
    line.base = numbers[0];
    line.gain = numbers[1];
}

// Takes an option off the front of rest; false, and nothing taken, where none stands there.
bool takeOption(std::string_view& rest, MapLine& line) {
    std::string_view ahead = rest;
    const std::string_view word = takeWord(ahead);
    const MapOption* option = findMapOption(word);
    if (option == nullptr) return false;
    std::vector<double> numbers;
    std::string_view value;
    if (option->kind == MapOptionKind::kNumbers)
        numbers = takeNumbers(ahead, option->numbers);
    else
        value = takeWord(ahead);
    if (option->isRendered && option->kind == MapOptionKind::kNumbers) {
        if (numbers.empty())
            numbers.push_back(option->option == std::string_view("-mm") ? 0
                                                                        : option->missingNumber);
        numbers.resize(option->numbers, option->missingNumber);
        setNumbers(word, numbers, line);
    } else if (equalInAnyCase(word, "-clamp")) {
        line.clamp = equalInAnyCase(value, "on");
    } else if (equalInAnyCase(word, "-colorspace")) {
        line.colourSpace = value;
    } else if (equalInAnyCase(word, "-imfchan")) {
        takeChannel(value, line);
    } else if (asksForSomething(word, numbers, value)) {
        line.leftOut.emplace_back(option->option);
    }
    rest = ahead;
    return true;
}

// Whether text is options and nothing else; sets them in line.
bool isOptionsOnly(std::string_view text, MapLine& line) {
    while (!text.empty() && !text.starts_with('#'))
        if (!takeOption(text, line)) return false;
    return true;
}

// An option that nobody has heard of: it and its numbers, or its on or off.
bool takeUnknownOption(std::string_view& rest, MapLine& line) {
    if (!rest.starts_with('-') || rest.find_first_of(" \t") == rest.npos) return false;
    line.leftOut.emplace_back(takeWord(rest));
    std::string_view ahead = rest;
    const std::string_view word = takeWord(ahead);
    constexpr std::size_t kMost = 8;
    if (equalInAnyCase(word, "on") || equalInAnyCase(word, "off"))
        rest = ahead;
    else
        takeNumbers(rest, kMost);
    return true;
}

}  // namespace

MapLine parseMapLine(std::string_view text, const std::function<bool(std::string_view)>& isFile) {
    MapLine line;
    std::string_view rest = trimmed(text);
    while (takeOption(rest, line) || (!isFile(rest) && takeUnknownOption(rest, line))) {
    }
    line.name = rest;
    MapLine shortest = line;
    bool isSplit = false;
    // Nobody writes more, and what is tried grows by the square of it.
    constexpr std::size_t kLongestOptions = 1024;
    const std::size_t first = rest.size() > kLongestOptions ? rest.size() - kLongestOptions : 1;
    for (auto at = rest.find('-', first); at < rest.size(); at = rest.find('-', at + 1)) {
        if (rest[at - 1] != ' ' && rest[at - 1] != '\t') continue;
        MapLine split = line;
        split.name = trimmed(rest.substr(0, at));
        if (!isOptionsOnly(rest.substr(at), split)) continue;
        if (!isSplit && isFile(rest)) return line;
        if (isFile(split.name)) return split;
        if (!isSplit) shortest = std::move(split);
        isSplit = true;
    }
    return shortest;
}

}  // namespace pm::host
