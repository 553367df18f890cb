// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// docs/obj_mtl.md names what the readers dispatch on: all of it, and nothing else.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>

#include "host_shim/formats/mtl/mtl_dialect.h"
#include "host_shim/formats/mtl/mtl_keys.h"
#include "host_shim/formats/obj/cage_tags.h"
#include "host_shim/formats/obj/obj_keys.h"
#include "tests/ingest/heard.h"

namespace pm::host::test {
namespace {

using Names = std::set<std::string>;

// The words in back quotes in the first cells of the table below a heading.
Names firstCells(const std::string& heading) {
    std::ifstream stream(PM_SOURCE_DIR "/docs/obj_mtl.md");
    Names names;
    bool isInside = false;
    for (std::string line; std::getline(stream, line);) {
        if (line.starts_with("## ")) isInside = line == "## " + heading;
        if (!isInside || !line.starts_with("| `")) continue;
        const std::string cell = line.substr(2, line.find('|', 2) - 2);
        for (auto at = cell.find('`'); at != cell.npos; at = cell.find('`', at + 1)) {
            const auto end = cell.find('`', at + 1);
            names.insert(cell.substr(at + 1, end - at - 1));
            at = end;
        }
    }
    return names;
}

template <typename Table, typename Name>
Names namesOf(const Table& table, Name name) {
    Names names;
    for (const auto& entry : table) names.insert(entry.*name);
    return names;
}

TEST(ObjMtlPage, HasEveryKeyThatIsRead) {
    EXPECT_EQ(firstCells("Keys of OBJ"), namesOf(objKeys(), &ObjKey::key));
    EXPECT_EQ(firstCells("Keys of MTL"), namesOf(mtlKeys(), &MtlKey::key));
    const std::vector<std::string> tags = cageTagNames();
    EXPECT_EQ(firstCells("Tags of cages"), Names(tags.begin(), tags.end()));
    EXPECT_EQ(firstCells("Options of map lines"), namesOf(mapOptions(), &MapOption::option));
    EXPECT_EQ(firstCells("Dialects"), namesOf(dialectNames(), &DialectName::name));
}

// What the page says is rendered, left out with a warning, or of no weight.
TEST(ObjMtlPage, SaysWhatIsTold) {
    const std::string quad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    for (const std::string& key : firstCells("Keys of OBJ")) {
        if (statementOf(key) != ObjStatement::kLeftOut &&
            statementOf(key) != ObjStatement::kNoWeight)
            continue;
        Heard heard;
        readObj(quad + key + " 1 2\n", "s.obj", ".", heard.sink);
        EXPECT_EQ(heard.has(Warning::kGeometry, "lines, points or curves"),
                  statementOf(key) == ObjStatement::kLeftOut)
            << key;
        EXPECT_FALSE(heard.has(Warning::kGeometry, "not understood")) << key;
    }
}

}  // namespace
}  // namespace pm::host::test
