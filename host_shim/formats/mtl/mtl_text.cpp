// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/mtl/mtl_text.h"

#include <cmath>
#include <utility>
#include <vector>

#include "host_shim/formats/mtl/mtl_keys.h"
#include "host_shim/formats/text_lines.h"
#include "host_shim/values/letter_case.h"

namespace pm::host {
namespace {

// As many numbers as are wanted, or fewer; none where one of them is no finite number.
std::vector<double> takeNumbers(std::string_view rest, std::size_t wanted) {
    std::vector<double> numbers;
    while (numbers.size() < wanted && !rest.empty() && !rest.starts_with('#')) {
        double value = 0;
        if (!parseNumber(takeWord(rest), value) || !std::isfinite(value)) return {};
        numbers.push_back(value);
    }
    return numbers;
}

void addStatement(std::string_view line, std::uint64_t number, MtlSection& section) {
    std::string_view rest = line;
    const std::string_view word = takeWord(rest);
    const MtlKey* const key = findMtlKey(word);
    const std::string name(key != nullptr ? std::string_view(key->meansKey) : word);
    section.lines.insert_or_assign(name, number);
    const auto notUnderstood = [&] {
        section.notUnderstood.insert_or_assign(name, std::string(trimmed(line)));
    };
    if (key == nullptr) {
        notUnderstood();
        return;
    }
    // -halo is an option of d that few write: the share still follows.
    if (name == "d" && equalInAnyCase(rest.substr(0, rest.find_first_of(" \t")), "-halo"))
        takeWord(rest);
    std::vector<double> numbers;
    switch (key->kind) {
        case MtlKind::kColour:
            // A colour of one number is grey; of two, two channels are anybody's guess.
            numbers = takeNumbers(rest, 3);
            if (numbers.size() == 1) numbers.resize(3, numbers.front());
            if (numbers.size() == 3)
                section.colours.insert_or_assign(name,
                                                 std::array{numbers[0], numbers[1], numbers[2]});
            else
                notUnderstood();
            break;
        case MtlKind::kNumber:
        case MtlKind::kNumberLeftOut:
            numbers = takeNumbers(rest, 1);
            if (numbers.empty())
                notUnderstood();
            else
                section.numbers.insert_or_assign(name, numbers.front());
            break;
        case MtlKind::kMap:
        case MtlKind::kMapLeftOut:
        case MtlKind::kMapOfNumber:
            section.maps.insert_or_assign(name, std::string(rest));
            break;
        case MtlKind::kNoWeight:
            break;
    }
}

}  // namespace

std::optional<std::array<double, 3>> MtlSection::colour(const std::string& key) const {
    const auto found = colours.find(key);
    if (found == colours.end()) return std::nullopt;
    return found->second;
}

std::optional<double> MtlSection::number(const std::string& key) const {
    const auto found = numbers.find(key);
    if (found == numbers.end()) return std::nullopt;
    return found->second;
}

void forEachMtlSection(std::string_view text,
                       const std::function<bool(const std::string& name)>& isWanted,
                       const std::function<void(MtlSection&&)>& visit) {
    std::optional<MtlSection> section;
    const auto finish = [&] {
        if (section) visit(std::move(*section));
        section.reset();
    };
    TextLines lines(text);
    while (lines.next()) {
        std::string_view rest = lines.line();
        if (equalInAnyCase(takeWord(rest), "newmtl")) {
            finish();
            std::string name(rest);
            if (!isWanted(name)) continue;
            section.emplace().name = std::move(name);
            section->lines["newmtl"] = lines.number();
        } else if (section) {
            addStatement(lines.line(), lines.number(), *section);
        }
    }
    finish();
}

}  // namespace pm::host
