// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/cli/unknown_words.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string_view>
#include <utility>

#include "host_shim/cli/foreign_words.h"
#include "host_shim/cli/letters_apart.h"
#include "host_shim/values/letter_case.h"

namespace pm::host {
namespace {

std::vector<std::string> longNames(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

// Letters and digits alone, in lower case.
std::string bare(std::string_view word) {
    std::string plain = lowerCase(word);
    std::erase_if(plain, [](char c) { return c == '-' || c == '_'; });
    return plain;
}

// The option that a word is written otherwise for, as --lookAt and --look_at; or "".
std::string otherSpelling(const CLI::App& app, std::string_view word) {
    const std::vector<std::string> names = longNames(app);
    const auto found = std::ranges::find(names, bare(word), bare);
    return found == names.end() ? std::string() : *found;
}

// The option that a word is a slip of the hand for, or its beginning; or "".
std::string likelyOption(const CLI::App& app, const std::string& word) {
    constexpr std::size_t kShortest = 5;  // of what may be a beginning, with its dashes
    std::string nearest;
    std::size_t least = kMostLettersApart + 1;
    std::vector<std::string> longer;
    for (const std::string& name : longNames(app)) {
        const std::size_t apart = lettersApart(name, word);
        if (word.size() >= kShortest && name.starts_with(word)) longer.push_back(name);
        if (apart >= least) continue;
        least = apart;
        nearest = name;
    }
    return longer.size() == 1 ? longer.front() : nearest;
}

bool isOption(const std::string& word) {
    return (word.starts_with('-') || word.starts_with('+')) && word.size() > 1;
}

std::string answerTo(const CLI::App& app, const std::string& name) {
    constexpr std::string_view kNone = "there is no such option";
    if (bare(name) == "denoise")
        return fmt::format("not available yet; {}", aboutForeignWord(name));
    std::string meant = otherSpelling(app, name);
    if (meant.empty()) {
        if (const std::string_view answer = aboutForeignWord(name); !answer.empty())
            return fmt::format("{}; {}", kNone, answer);
        meant = likelyOption(app, name);
    }
    return meant.empty() ? std::string(kNone) : fmt::format("{}; is {} meant?", kNone, meant);
}

// "samples=64" is no file either.
bool isForeignPair(const std::string& word) {
    const auto equals = word.find('=');
    return equals != std::string::npos && !aboutForeignWord(word.substr(0, equals)).empty();
}

}  // namespace

std::string aboutUnknownWords(const CLI::App& app, const std::vector<std::string>& unknown) {
    std::vector<std::pair<std::string, std::string>> told;  // names, answer
    for (const std::string& word : unknown) {
        if (!isOption(word) && !isForeignPair(word)) continue;
        const std::string name = word.substr(0, word.find('='));
        std::string answer = answerTo(app, name);
        const auto same =
            std::ranges::find(told, answer, [](const auto& one) { return one.second; });
        if (same == told.end())
            told.emplace_back(name, std::move(answer));
        else if (same->first != name)
            same->first += ", " + name;
    }
    if (told.empty()) return fmt::format("'{}': one scene is wanted", fmt::join(unknown, " "));
    std::string text;
    for (const auto& [names, answer] : told)
        text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", names, answer);
    return text;
}

std::string aboutSigns(const CLI::App& app, const std::vector<std::string>& arguments) {
    for (const std::string& word : arguments) {
        if (word.starts_with('+') && !aboutForeignWord(word).empty())
            return fmt::format("{}: {}", word, answerTo(app, word));
        const std::string name = word.substr(0, word.find('='));
        if (name.size() < 4 || name[0] != '-' || name[1] == '-') continue;
        const std::string meant = otherSpelling(app, name);
        const bool isNumber = name.find_first_of("0123456789.") == 1;
        if (isNumber || (meant.empty() && aboutForeignWord(name).empty())) continue;
        return fmt::format("{}: {}", name, answerTo(app, name));
    }
    return {};
}

}  // namespace pm::host
