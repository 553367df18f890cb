// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace pm::host {

// One newmtl section. tinyobjloader forgets which statements were there, lets Kd of one material
// set what is assumed for the next, reads a lone `Kd 0.5` as 0.5 0 0, and takes the file name of
// `map_Kd -s 2 2 wood.png` for the third number: so each section is cleaned and parsed alone.
struct MtlSection {
    std::string name;
    std::string cleaned;
    std::map<std::string, std::uint64_t> lines;        // statement -> line where it stands
    std::map<std::string, std::string> notUnderstood;  // statement -> its text, left out
    std::string transmissionMap;                       // map_Tf or map_Kt, which the parser drops

    bool has(const std::string& statement) const { return lines.contains(statement); }
};

// Splits the text of an MTL file. Statements before the first newmtl are dropped. No errors.
std::vector<MtlSection> readMtlText(std::string_view text);

}  // namespace pm::host
