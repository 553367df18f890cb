// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/ingest/file_names.h"

#include "host_shim/ingest/text_lines.h"

#include <algorithm>
#include <vector>

namespace pm::host {
namespace {

namespace fs = std::filesystem;

char lowerCase(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

// The first by name where there are several, as folders have no order.
std::optional<fs::path> inAnyCase(fs::path at, const fs::path& wanted) {
    for (const fs::path& part : wanted) {
        std::error_code error;
        if (fs::exists(at / part, error)) {
            at /= part;
            continue;
        }
        std::optional<fs::path> found;
        for (fs::directory_iterator entry(at.empty() ? "." : at, error), end;
             !error && entry != end; entry.increment(error)) {
            const fs::path name = entry->path().filename();
            if (std::ranges::equal(name.native(), part.native(), {}, lowerCase, lowerCase) &&
                (!found || name < *found)) {
                found = name;
            }
        }
        if (!found) return std::nullopt;
        at /= *found;
    }
    return at;
}

std::string_view withoutQuotes(std::string_view text) {
    const bool isQuoted = text.size() > 2 && text.starts_with('"') && text.ends_with('"');
    return isQuoted ? text.substr(1, text.size() - 2) : text;
}

}  // namespace

std::string_view withoutComment(std::string_view text) {
    for (std::size_t at = 1; at < text.size(); ++at) {
        const bool isAfterBlank = text[at - 1] == ' ' || text[at - 1] == '\t';
        if (text[at] == '#' && isAfterBlank) return trimmed(text.substr(0, at));
    }
    return text;
}

std::optional<fs::path> findFile(const fs::path& folder, std::string_view name) {
    std::error_code error;
    std::vector<std::string> names{std::string(name),
                                   std::string(withoutQuotes(withoutComment(name)))};
    for (std::size_t i = 0; i < 2; ++i) {
        std::string slashed = names[i];
        std::ranges::replace(slashed, '\\', '/');
        names.push_back(std::move(slashed));
    }
    for (const std::string& candidate : names)
        if (fs::is_regular_file(folder / candidate, error)) return folder / candidate;
    for (const std::string& candidate : names) {
        auto found = inAnyCase(folder, candidate);
        if (found && fs::is_regular_file(*found, error)) return found;
    }
    return std::nullopt;
}

}  // namespace pm::host
