// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/check/render_facts.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "host_shim/formats/json/json_reader.h"
#include "host_shim/process/interrupt.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kWarning = "pm_host: warning: ";
constexpr std::string_view kTexture = "texture ";
constexpr std::size_t kMostNamed = 8;

// Hashes of the render as a whole, which the picture has as well.
bool isOfAll(const std::string& name) {
    return name == "scene" || name == "settings";
}

// A name as it is on every machine.
std::string named(const std::string& name, const fs::path& folder) {
    if (!name.starts_with(kTexture)) return name;
    const fs::path file = name.substr(kTexture.size());
    const fs::path relative = file.is_absolute() ? file.lexically_relative(folder) : file;
    return std::string(kTexture) + (relative.empty() ? file : relative).generic_string();
}

std::string without(std::string text, const std::string& folder) {
    const std::string path = folder + "/";
    for (auto at = text.find(path); at != text.npos; at = text.find(path, at))
        text.erase(at, path.size());
    return text;
}

std::vector<std::string> warningsIn(const fs::path& log, const fs::path& folder) {
    std::vector<std::string> warnings;
    std::ifstream stream(log);
    for (std::string line; std::getline(stream, line);) {
        if (!line.starts_with(kWarning)) continue;
        std::string text = without(line.substr(kWarning.size()), folder.string());
        if (std::ranges::find(warnings, text) == warnings.end())
            warnings.push_back(std::move(text));
    }
    return warnings;
}

bool isDigit(char c) {
    return c >= '0' && c <= '9';
}

// What counts, measures or is a line of a file; digits within names stay.
std::string withoutNumbers(const std::string& text) {
    constexpr std::string_view kBefore = " :,(\t", kWithin = ".eE+-x";
    std::string result;
    for (std::size_t i = 0; i < text.size();) {
        const bool begins =
            isDigit(text[i]) && (i == 0 || kBefore.find(text[i - 1]) != kBefore.npos);
        if (!begins) {
            result += text[i++];
            continue;
        }
        while (i < text.size() && (isDigit(text[i]) || kWithin.find(text[i]) != kWithin.npos)) ++i;
    }
    return result;
}

std::string list(const std::vector<std::string>& names) {
    const std::size_t shown = std::min(names.size(), kMostNamed);
    std::string text = fmt::format(
        "{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
    if (shown < names.size()) text += fmt::format(" and {} more", names.size() - shown);
    return text;
}

}  // namespace

RenderFacts readFacts(const fs::path& statistics, const fs::path& log, const Picture& picture,
                      const fs::path& folder) {
    RenderFacts facts;
    const auto json = parseJsonFile(statistics, throwIfInterrupted);
    if (const auto hashes = json.find("hashes"); hashes != json.end() && hashes->is_object())
        for (const auto& [name, hash] : hashes->items())
            if (hash.is_string() && !isOfAll(name)) facts.inputs[named(name, folder)] = hash;
    facts.errorWords = json.value("errorWords", "");
    if (const auto id = picture.attributes.find("pm:ocioCacheId"); id != picture.attributes.end())
        if (const auto* text = std::get_if<std::string>(&id->second))
            facts.inputs["config"] = *text;
    facts.warnings = warningsIn(log, folder);
    return facts;
}

std::string differences(const SceneInputs& before, const SceneInputs& now) {
    std::vector<std::string> changed, added, gone;
    for (const auto& [name, hash] : now) {
        const auto found = before.find(name);
        if (found == before.end())
            added.push_back(name);
        else if (found->second != hash)
            changed.push_back(name);
    }
    for (const auto& [name, hash] : before)
        if (!now.contains(name)) gone.push_back(name);
    std::string text = list(changed);
    for (const auto& [word, names] : {std::pair{"new", &added}, std::pair{"gone", &gone}})
        if (!names->empty())
            text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", word, list(*names));
    return text;
}

std::vector<std::string> newWarnings(const std::vector<std::string>& before,
                                     const std::vector<std::string>& now) {
    std::vector<std::string> known, fresh;
    for (const std::string& text : before) known.push_back(withoutNumbers(text));
    for (const std::string& text : now)
        if (std::ranges::find(known, withoutNumbers(text)) == known.end()) fresh.push_back(text);
    return fresh;
}

}  // namespace pm::host
