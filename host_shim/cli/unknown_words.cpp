// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/cli/unknown_words.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <numeric>
#include <string_view>
#include <utility>

namespace pm::host {
namespace {

// Letters to add, drop or change to make one word of the other (Levenshtein 1966).
std::size_t lettersApart(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i + 1);
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = std::exchange(row[j + 1], std::min({changed, row[j] + 1, row[j + 1] + 1}));
        }
    }
    return row.back();
}

// The option that a word is a slip of the hand for, or "".
std::string likelyOption(const CLI::App& app, std::string_view word) {
    constexpr std::size_t kMostLetters = 2;
    std::string nearest;
    std::size_t least = kMostLetters + 1;
    for (const CLI::Option* option : app.get_options())
        for (const std::string& name : option->get_lnames()) {
            const std::size_t apart = lettersApart("--" + name, word);
            if (apart < least) {
                least = apart;
                nearest = "--" + name;
            }
        }
    return nearest;
}

}  // namespace

std::string aboutUnknownWords(const CLI::App& app, const std::vector<std::string>& unknown) {
    const auto option = std::ranges::find_if(
        unknown, [](const std::string& word) { return word.starts_with('-') && word != "-"; });
    if (option == unknown.end())
        return fmt::format("'{}': one scene is wanted", fmt::join(unknown, " "));
    const std::string name = option->substr(0, option->find('='));
    const std::string likely = likelyOption(app, name);
    return name + ": there is no such option" +
           (likely.empty() ? std::string() : fmt::format("; is {} meant?", likely));
}

}  // namespace pm::host
