// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Map lines of MTL files: options before the name and after it, and names that look like options.
#include "host_shim/formats/mtl/map_line.h"

#include <gtest/gtest.h>

#include <set>

namespace pm::host::test {
namespace {

MapLine parse(std::string_view text, const std::set<std::string>& files = {}) {
    return parseMapLine(
        text, [&files](std::string_view name) { return files.contains(std::string(name)); });
}

TEST(MapLine, OptionsBeforeAndAfterTheName) {
    for (const char* text :
         {"-s 2 3 -o 0.5 -mm 0.1 0.5 -clamp on -colorspace sRGB my wood.png",
          "my wood.png -s 2 3 -o 0.5 -mm 0.1 0.5 -clamp on -colorspace sRGB",
          "-s 2 3 -o 0.5 my wood.png -mm 0.1 0.5 -clamp on -colorspace sRGB # oak",
          "-S 2 3 -O 0.5\tmy wood.png\t-MM 0.1 0.5 -Clamp ON -colorSpace sRGB"}) {
        const MapLine line = parse(text);
        EXPECT_EQ(line.name, "my wood.png") << text;
        EXPECT_EQ(line.scale, (std::array<double, 3>{2, 3, 1})) << text;
        EXPECT_EQ(line.offset, (std::array<double, 3>{0.5, 0, 0})) << text;
        EXPECT_EQ(line.base, 0.1) << text;
        EXPECT_EQ(line.gain, 0.5) << text;
        EXPECT_TRUE(line.clamp) << text;
        EXPECT_EQ(line.colourSpace, "sRGB") << text;
        EXPECT_TRUE(line.leftOut.empty()) << text;
    }
}

TEST(MapLine, NumbersThatAreNotWritten) {
    EXPECT_EQ(parse("-s 2 a.png").scale, (std::array<double, 3>{2, 1, 1}));
    EXPECT_EQ(parse("-o 2 a.png").offset, (std::array<double, 3>{2, 0, 0}));
    EXPECT_EQ(parse("-mm 0.25 a.png").gain, 1);
    EXPECT_EQ(parse("-s a.png").name, "a.png");
    EXPECT_EQ(parse("-s 1 2 3 4.png").name, "4.png");
    EXPECT_EQ(parse("-s 2 2").name, "");
    EXPECT_EQ(parse("").name, "");
    EXPECT_EQ(parse("-s nan inf a.png").name, "nan inf a.png");
}

// -cc and its like are no part of the name.
TEST(MapLine, WhatIsNotDoneIsNamed) {
    for (const char* text : {"-cc on a.png", "a.png -cc on", "-imfchan q a.png", "-t 1 a.png",
                             "-boost 2 a.png", "-type sphere a.png", "-shade 3 a.png"}) {
        const MapLine line = parse(text);
        EXPECT_EQ(line.name, "a.png") << text;
        EXPECT_EQ(line.leftOut.size(), 1u) << text;
    }
    for (const char* text : {"-cc off a.png", "-imfchan m a.png", "-t 0 0 0 a.png",
                             "-blendu on -blendv off a.png", "-bm 1 a.png", "-texres 512 a.png"}) {
        const MapLine line = parse(text);
        EXPECT_EQ(line.name, "a.png") << text;
        EXPECT_TRUE(line.leftOut.empty()) << text;
    }
}

TEST(MapLine, OneChannelMayBeAskedFor) {
    EXPECT_EQ(parse("-imfchan G a.png").channel, 'g');
    EXPECT_EQ(parse("a.png -imfchan l").channel, 'l');
    EXPECT_EQ(parse("-imfchan m a.png").channel, '\0');
    EXPECT_EQ(parse("a.png").channel, '\0');
}

TEST(MapLine, NamesThatLookLikeOptionsAreNamesWhereTheyAreFiles) {
    EXPECT_EQ(parse("wall -s 2.png", {"wall -s 2.png"}).name, "wall -s 2.png");
    EXPECT_EQ(parse("wall -o", {"wall -o"}).name, "wall -o");
    EXPECT_EQ(parse("wall -o", {}).name, "wall");
    EXPECT_EQ(parse("-x 1.png", {"-x 1.png"}).name, "-x 1.png");
    EXPECT_EQ(parse("a -s 2 -o 1", {"a -s 2"}).name, "a -s 2");
    EXPECT_EQ(parse("a -s 2 -o 1", {"a -s 2"}).offset[0], 1);
    EXPECT_EQ(parse("a -s 2 -o 1", {"a -s 2"}).scale[0], 1);
    EXPECT_EQ(parse("wood - old.png").name, "wood - old.png");
    EXPECT_EQ(parse("-old.png").name, "-old.png");
    EXPECT_EQ(parse("\"my wood.png\" -clamp on").name, "\"my wood.png\"");
}

}  // namespace
}  // namespace pm::host::test
