// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Names come from files and may hold anything: none of it reaches what a terminal or a page obeys.
#include "host_shim/process/plain_text.h"

#include <nlohmann/json.hpp>

#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

TEST(PlainText, KeepsWhatPeopleWrite) {
    for (const char* text :
         {"", "plain", "\u00e9\u00df\u4e2d\U0001f600 \u05d0\u0628 a\\b", "\ufffd"}) {
        EXPECT_EQ(plainText(text), text);
        EXPECT_EQ(plainLines(text), text);
        EXPECT_EQ(plainJson(text), text);
    }
    EXPECT_EQ(plainText("a\nb\tc"), "a b c");
    EXPECT_EQ(plainLines("a\nb\tc"), "a\nb\tc");
}

TEST(PlainText, EscapesWhatATerminalObeys) {
    EXPECT_EQ(plainText("\x1b[31m\x07\x7f\r"), "\\x1b[31m\\x07\\x7f\\x0d");
    EXPECT_EQ(plainText("\u0080\u009b\u009f\u00a0"), "\\x80\\x9b\\x9f\u00a0");
    EXPECT_EQ(plainText("\u202a\u202e\u2066\u2069\u200e\u200f\u061c"),
              "\\u202a\\u202e\\u2066\\u2069\\u200e\\u200f\\u061c");
    EXPECT_EQ(plainText("\u2028\u2029\u202f\u206a"), "\\u2028\\u2029\u202f\u206a");
    EXPECT_EQ(plainJson("\"\u009b\u202e\""), "\"\\u009b\\u202e\"");
    EXPECT_EQ(plainText(std::string("a\0b", 3)), "a\\x00b");
}

TEST(PlainText, EscapesWhatIsNoUtf8) {
    EXPECT_EQ(plainText("\x9b"
                        "31m"),
              "\\x9b31m");
    EXPECT_EQ(plainText("\xe9t\xe9"), "\\xe9t\\xe9");  // Latin-1
    EXPECT_EQ(plainText("\xc3"), "\\xc3");
    EXPECT_EQ(plainText("\xc2\xc2\x9b"), "\\xc2\\x9b");
    EXPECT_EQ(plainText("\xc0\x9b"), "\\xc0\\x9b");  // longer than needed
    EXPECT_EQ(plainText("\xe0\x82\x9b"), "\\xe0\\x82\\x9b");
    EXPECT_EQ(plainText("\xed\xa0\x80"), "\\xed\\xa0\\x80");           // a surrogate
    EXPECT_EQ(plainText("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond Unicode
    EXPECT_EQ(plainText("\xf5"), "\\xf5");
}

class Names : public HostProcess {};

// C1, an override and Latin-1 in the names of a material, a group, a library, a picture and files.
TEST_F(Names, ReachNeitherTerminalNorLogNorPage) {
    const std::string evil = "n\u009b31m\u202e\xe9\x1b]0;x\x07";
    write("m" + evil + ".mtl", "newmtl a" + evil + "\nKd 1 1 1\nmap_Kd " + evil + ".png\n");
    write(evil + ".obj", "mtllib m" + evil + ".mtl\nmtllib no" + evil + ".mtl\nv 0 0 0\nv 1 0 0\n" +
                             "v 0 1 0\ng " + evil + "\nusemtl a" + evil + "\nf 1 2 3\nf 1 1 2\n" +
                             "usemtl none" + evil + "\nf 1 2 3\n" + evil + " 1\n");
    const Outcome outcome =
        run({evil + ".obj", "--size", "8x8", "--passes", "1", "-v", "-o", "o" + evil + ".exr",
             "--log", "l", "--stats", "s", "--report", "r.html"});
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    const Outcome refused = run({"no" + evil + ".obj"});
    const Outcome unknown = run({"--" + evil});
    const Outcome listed = run({"--list", "views", "--view", evil});
    for (const std::string& text :
         {outcome.err, outcome.out, readText(path("l")), readText(path("s")),
          readText(path("r.html")), refused.err, unknown.err, listed.err}) {
        EXPECT_EQ(text, plainLines(text)) << text;
        EXPECT_FALSE(text.find("\xe9") != std::string::npos);
    }
    EXPECT_NE(outcome.err.find("n\\x9b31m\\u202e\\xe9\\x1b]0;x\\x07"), std::string::npos);
    EXPECT_TRUE(nlohmann::json::parse(readText(path("s"))).is_object());
}

}  // namespace
}  // namespace pm::host::test
