// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/file_names.h"

#include <algorithm>

#include "host_shim/formats/text_encoding.h"
#include "host_shim/formats/text_lines.h"
#include "host_shim/values/letter_case.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

std::string_view withoutQuotes(std::string_view text) {
    const bool isQuoted = text.size() > 2 && (text.front() == '"' || text.front() == '\'') &&
                          text.back() == text.front();
    return isQuoted ? text.substr(1, text.size() - 2) : text;
}

void addNew(std::string text, std::vector<std::string>& texts) {
    if (!text.empty() && std::ranges::find(texts, text) == texts.end())
        texts.push_back(std::move(text));
}

}  // namespace

std::string_view withoutComment(std::string_view text) {
    for (std::size_t at = 1; at < text.size(); ++at) {
        const bool isAfterBlank = text[at - 1] == ' ' || text[at - 1] == '\t';
        if (text[at] == '#' && isAfterBlank) return trimmed(text.substr(0, at));
    }
    return text;
}

std::optional<std::string> FolderNames::inAnyCase(const fs::path& folder, const std::string& name) {
    const auto [found, isNew] = m_folders.try_emplace(folder);
    std::map<std::string, std::string>& entries = found->second;
    if (isNew) {
        std::error_code error;
        for (fs::directory_iterator entry(folder.empty() ? "." : folder, error), end;
             !error && entry != end; entry.increment(error)) {
            std::string own = entry->path().filename().string();
            const auto [place, isFirst] = entries.try_emplace(lowerCase(own), own);
            if (!isFirst && own < place->second) place->second = std::move(own);
        }
    }
    const auto entry = entries.find(lowerCase(name));
    if (entry == entries.end()) return std::nullopt;
    return entry->second;
}

std::vector<std::string> readingsOf(std::string_view name) {
    std::vector<std::string> readings;
    addNew(std::string(name), readings);
    addNew(std::string(withoutQuotes(name)), readings);
    addNew(std::string(withoutQuotes(withoutComment(name))), readings);
    for (std::size_t i = 0, count = readings.size(); i < count; ++i) {
        std::string slashed = readings[i];
        std::ranges::replace(slashed, '\\', '/');
        addNew(std::move(slashed), readings);
    }
    for (std::size_t i = 0, count = readings.size(); i < count; ++i)
        addNew(inOtherEncoding(readings[i]), readings);
    return readings;
}

std::vector<std::string> tailsOf(std::string_view name) {
    constexpr std::size_t kMostParts = 16;
    std::vector<std::string> parts;
    std::string slashed(withoutQuotes(withoutComment(name)));
    std::ranges::replace(slashed, '\\', '/');
    std::size_t size = 0;
    for (std::string_view rest = slashed; !rest.empty();) {
        const auto end = std::min(rest.find('/'), rest.size());
        const std::string_view part = rest.substr(0, end);
        rest.remove_prefix(std::min(end + 1, rest.size()));
        ++size;
        // Whatever stands before a way up or a drive is of the other machine.
        if (part == ".." || part.ends_with(':'))
            parts.clear();
        else if (!part.empty() && part != ".")
            parts.emplace_back(part);
    }
    if (parts.size() > kMostParts)
        parts.erase(parts.begin(), parts.end() - static_cast<std::ptrdiff_t>(kMostParts));
    std::vector<std::string> tails;
    std::string tail;
    for (auto part = parts.rbegin(); part != parts.rend(); ++part) {
        tail = tail.empty() ? *part : *part + "/" + tail;
        tails.insert(tails.begin(), tail);
    }
    // The whole of a plain name is no tail of it.
    if (size == parts.size() && !tails.empty()) tails.erase(tails.begin());
    return tails;
}

std::optional<fs::path> findFile(const fs::path& folder, const std::string& name,
                                 FolderNames& names) {
    std::error_code error;
    if (fs::is_regular_file(folder / name, error)) return folder / name;
    fs::path at = folder;
    for (const fs::path& part : fs::path(name)) {
        if (part.empty() || part.is_absolute() || fs::exists(at / part, error)) {
            at /= part;
            continue;
        }
        const auto entry = names.inAnyCase(at, part.string());
        if (!entry) return std::nullopt;
        at /= *entry;
    }
    if (!fs::is_regular_file(at, error)) return std::nullopt;
    return at;
}

}  // namespace pm::host
