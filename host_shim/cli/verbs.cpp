// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/cli/verbs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <utility>

#include "host_shim/cli/letters_apart.h"
#include "host_shim/values/letter_case.h"

namespace pm::host {
namespace {

constexpr std::array<std::pair<std::string_view, Command>, 6> kVerbs{{
    {"cache", Command::kCache},
    {"check", Command::kCheck},
    {"farm", Command::kFarm},
    {"merge", Command::kMerge},
    {"pack", Command::kPack},
    {"watch", Command::kWatch},
}};
// What other programs have as a verb, and what does the same here.
constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kOtherVerbs{{
    {"render", "pm_host SCENE [options]"},
    {"help", "pm_host -h"},
    {"version", "pm_host --version"},
    {"explain", "pm_host SCENE --explain"},
    {"info", "pm_host SCENE --explain"},
    {"list", "pm_host --list WHAT"},
}};

// A name of a file, an address, a number or an option is no verb.
bool mayBeVerb(const std::string& word) {
    constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
    std::error_code ignored;
    return word.size() > 1 && word.find_first_not_of(kLetters) == std::string::npos &&
           !std::filesystem::exists(word, ignored);
}

// The command line that a word is likely meant for, or "".
std::string likelyCommand(const std::string& word) {
    std::string likely;
    // Of a short word two letters are half.
    std::size_t least = std::min(kMostLettersApart, (word.size() - 1) / 2) + 1;
    const auto consider = [&](std::string_view verb, std::string_view command) {
        const std::size_t apart = lettersApart(lowerCase(word), verb);
        if (apart >= least) return;
        least = apart;
        likely = command;
    };
    for (const auto& [verb, command] : kVerbs) consider(verb, fmt::format("pm_host {}", verb));
    for (const auto& [verb, command] : kOtherVerbs) consider(verb, command);
    return likely;
}

bool isVerb(const std::string& word) {
    return std::ranges::find(kVerbs, word, [](const auto& verb) { return verb.first; }) !=
           kVerbs.end();
}

}  // namespace

Command commandOf(const std::vector<std::string>& arguments) {
    if (arguments.empty()) return Command::kRender;
    for (const auto& [verb, command] : kVerbs)
        if (arguments.front() == verb) return command;
    return Command::kRender;
}

std::string aboutVerbs(const std::vector<std::string>& arguments, bool hasMoreWords) {
    if (arguments.empty()) return {};
    const std::string& first = arguments.front();
    if (mayBeVerb(first)) {
        const std::string likely = likelyCommand(first);
        if (likely.empty() && !hasMoreWords) return {};
        return fmt::format(
            "'{}': there is no such verb{}; verbs are cache, check, farm, merge, pack and watch, "
            "and without one a scene is rendered: pm_host SCENE [options]",
            first, likely.empty() ? std::string() : fmt::format("; is {} meant?", likely));
    }
    const auto late = std::find_if(arguments.begin() + 1, arguments.end(), isVerb);
    if (!hasMoreWords || !first.starts_with('-') || late == arguments.end()) return {};
    return fmt::format("'{}': a verb is the first word: pm_host {} ...", *late, *late);
}

}  // namespace pm::host
