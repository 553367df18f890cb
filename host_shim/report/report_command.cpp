// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/report/report_command.h"

#include <algorithm>
#include <set>
#include <string_view>

namespace pm::host {
namespace {

std::string quoted(const std::string& argument) {
    constexpr std::string_view kPlain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:@%";
    if (!argument.empty() && argument.find_first_not_of(kPlain) == std::string::npos)
        return argument;
    std::string text = "'";
    for (const char c : argument) {
        if (c == '\'')
            text.append("'\\''");
        else
            text.push_back(c);
    }
    text.push_back('\'');
    return text;
}

struct Removed {
    std::set<std::string_view> withValue;
    std::set<std::string_view> flags;
    bool output{};  // -o too, also behind flags in one word
};

// How many words from this one on are to go.
std::size_t wordsToRemove(const std::string& word, const Removed& removed) {
    const std::string_view name = std::string_view(word).substr(0, word.find('='));
    if (removed.flags.contains(name)) return 1;
    if (removed.withValue.contains(name)) return name.size() == word.size() ? 2 : 1;
    if (!removed.output || !word.starts_with('-') || word.starts_with("--")) return 0;
    // -o FILE, -oFILE, -qo FILE
    const std::size_t letter = word.find_first_not_of("qv", 1);
    if (letter == std::string::npos || word[letter] != 'o') return 0;
    return letter + 1 == word.size() ? 2 : 1;
}

Arguments without(const Arguments& arguments, const Removed& removed) {
    Arguments kept;
    for (std::size_t i = 0; i < arguments.size();) {
        const std::size_t gone = i == 0 ? 0 : wordsToRemove(arguments[i], removed);
        if (gone == 0) kept.push_back(arguments[i]);
        i += std::max<std::size_t>(gone, 1);
    }
    return kept;
}

}  // namespace

std::string shellCommand(const Arguments& arguments) {
    std::string text;
    for (const std::string& argument : arguments) {
        if (!text.empty()) text.push_back(' ');
        text += quoted(argument);
    }
    return text;
}

Arguments ofPasses(const Arguments& arguments, long long passes) {
    auto words = without(arguments, {{"--error-target", "--time-limit", "--passes"}, {}, false});
    words.insert(words.end(), {"--passes", std::to_string(passes)});
    return words;
}

Arguments ofOnePixel(const Arguments& arguments) {
    return without(arguments, {{"--output", "--stats", "--log", "--report", "--checkpoint",
                                "--buckets", "--crop", "--only-pixel", "--reference",
                                "--error-limit", "--error-target", "--time-limit"},
                               {"--resume", "--keep-checkpoint", "--make-output-path"},
                               true});
}

}  // namespace pm::host
