// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace pm::host {

// One newmtl section, statement by statement, as it stands. Of two statements with the same key
// the last counts. Keys are those of mtlKeys(), under the name that they mean. (tinyobjloader's own
// reader forgets which statements were there, lets one material set what is assumed for the next,
// and takes options that it doesn't know for names of files.)
struct MtlSection {
    std::string name;
    std::map<std::string, std::uint64_t> lines;        // key -> line where it stands
    std::map<std::string, std::string> notUnderstood;  // key -> its text, left out
    std::map<std::string, std::array<double, 3>> colours;
    std::map<std::string, double> numbers;
    std::map<std::string, std::string> maps;  // key -> options and name, as they stand

    // None where it isn't given or isn't understood.
    std::optional<std::array<double, 3>> colour(const std::string& key) const;
    std::optional<double> number(const std::string& key) const;
    bool hasMap(const std::string& key) const { return maps.contains(key); }
};

// Visits the sections of an MTL file, one after the other, but for those of whose names isWanted
// says no. Statements before the first newmtl are dropped. No errors but those of visit.
void forEachMtlSection(std::string_view text,
                       const std::function<bool(const std::string& name)>& isWanted,
                       const std::function<void(MtlSection&&)>& visit);

}  // namespace pm::host
