// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// OBJ ingest on small texts: what is kept, what is refused and at which line.
#include <gtest/gtest.h>

#include <clocale>
#include <string>

#include "host_shim/formats/lamps.h"
#include "tests/ingest/heard.h"

namespace pm::host::test {
namespace {

const std::string kQuad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

SceneData read(const std::string& text) {
    Heard heard;
    return readObj(text, "scene.obj", ".", heard.sink);
}
std::string refusal(const std::string& text) {
    return errorOf([&] { read(text); });
}

TEST(Obj, keepsPolygonsAndRecentresThem) {
    const SceneData scene = read("v 800000.0123456 0 0\nv 800001 0 0\nv 800001 1 0\nf 1 2 3\n");
    ASSERT_EQ(scene.meshes.size(), 1u);
    EXPECT_DOUBLE_EQ(scene.bounds.low[0], 800000.0123456);
    // In float alone the corner would sit at 800000 exactly.
    EXPECT_NEAR(static_cast<double>(scene.meshes[0].positions[0]) + scene.centre[0], 800000.0123456,
                1e-7);
    const SceneData quad = read(kQuad + "f 1 2 3 4\n");
    EXPECT_EQ(quad.meshes[0].faceSizes, std::vector<std::uint32_t>{4});
}

// A quad of width 1, and other vertices far away: the former keeps its digits where the camera
// stands there, or where it is more.
TEST(Obj, whatIsFarAwayLeavesDigitsToTheRest) {
    const std::string room = "v 0 0 0.1\nv 1 0 0.1\nv 1 1 0.1\nv 0 1 0.1\nf 1 2 3 4\n";
    std::string stray = "v 1e8 0 0\nv 1e8 1 0\nv 1e8 0 1\nf -3 -2 -1\n";
    EXPECT_EQ(read(room + stray).centre, (std::array<double, 3>{0.5, 0.5, 0.1}));
    for (int i = 0; i < 3; ++i) stray += stray;
    const std::array<double, 3> eye = {0.5, 0.5, 3};
    const SceneData near = readObj(
        room + stray, "scene.obj", ".", [](Warning, const std::string&) {}, {}, eye);
    EXPECT_EQ(near.centre, (std::array<double, 3>{0.5, 0.5, 0.1}));
    EXPECT_GT(read(room + stray).centre[0], 9e7);
    // Less far than that it is as it was: the middle of all.
    EXPECT_EQ(read(room + "v 100 0 0\nv 100 1 0\nv 100 0 1\nf 5 6 7\n").centre[0], 50.0);
}

TEST(Obj, boundsLeaveOutVerticesThatNoFaceHas) {
    const SceneData scene = read(kQuad + "v 1000 0 0\nf 1 2 3\n");
    EXPECT_EQ(scene.bounds.high[0], 1.0);
    EXPECT_EQ(scene.meshes[0].positions.size(), 9u);
}

TEST(Obj, refusesIndicesOutOfRangeWithTheLine) {
    EXPECT_EQ(refusal(kQuad + "f 1 2 9001\n"), "3 scene.obj:5: face refers to vertex 9001 of 4");
    EXPECT_EQ(refusal(kQuad + "f 1 2 -5\n"), "3 scene.obj:5: face refers to vertex -5 of 4 so far");
    EXPECT_EQ(refusal(kQuad + "vt 0 0\nf 1/1 2/1 3/2\n"),
              "3 scene.obj:6: face refers to texture coordinate 2 of 1");
    EXPECT_EQ(refusal(kQuad + "vn 0 0 1\n\nf 1//1 2//1 3//2\n"),
              "3 scene.obj:7: face refers to normal 2 of 1");
    EXPECT_EQ(refusal(kQuad + "f 0 1 2\n"),
              "3 scene.obj:5: face refers to vertex 0; the first is 1 (or -1, counted back)");
}

// As files of OpenSubdiv's and others have it.
TEST(Obj, numbersOfNormalsOfWhichThereAreNoneAreLeftOut) {
    for (const std::string corners : {"1//1 2//2 3//3", "1/1 2/1 3/1", "1/4/1 2/5/2 3/6/3"}) {
        const SceneData scene = read(kQuad + "f " + corners + "\n");
        ASSERT_EQ(scene.meshes.size(), 1u) << corners;
        EXPECT_TRUE(scene.meshes[0].normals.empty()) << corners;
        EXPECT_TRUE(scene.meshes[0].uvs.empty()) << corners;
    }
    std::string told;
    readObj(kQuad + "f 1//1 2//2 3//3\n", "scene.obj", {},
            [&](Warning, const std::string& text) { told += text + "\n"; });
    EXPECT_EQ(told, "scene.obj:5: 3 corners' normals, of which there are none, left out\n");
}

TEST(Obj, indicesMayPointForward) {
    const SceneData scene = read(std::string("f 1 2 3\n") + kQuad);
    EXPECT_EQ(scene.faceCount, 1u);
}

TEST(Obj, refusesVerticesThatAreNotFinite) {
    for (const std::string bad : {"nan", "-nan", "inf", "1e400", "1e30", "1.#IND", "abc"}) {
        const std::string text =
            refusal(std::string("# head\nv 0 ") + bad + " 0\n" + kQuad + "f 1 2 3\n");
        EXPECT_TRUE(text.starts_with("3 scene.obj:2: vertex coordinate")) << text;
    }
    EXPECT_TRUE(refusal("v 1 2\nv 0 0 0\nv 1 0 0\nf 1 2 3\n").starts_with("3 scene.obj:1:"));
    EXPECT_EQ(read("v 1e-400 +0 0\nv 1 0 0\nv .5 5. 1E0\nf 1 2 3\n").faceCount, 1u);
}

TEST(Obj, refusesCornersThatAreNone) {
    const std::string text = refusal(kQuad + "f 1 2x 3\n");
    EXPECT_TRUE(text.starts_with("3 scene.obj:5: '2x' is not a face corner")) << text;
    EXPECT_TRUE(refusal(kQuad + "f 1/1/1/1 2 3\n").starts_with("3 scene.obj:5:"));
    EXPECT_TRUE(refusal(kQuad + "f 1 2 \xE9\n").starts_with("3 scene.obj:5:"));
}

TEST(Obj, saysThatThereIsNoGeometry) {
    for (const std::string& text :
         {std::string(), kQuad, std::string("\xFE\xFF\0v\0 \0001", 8), std::string("f\n")}) {
        EXPECT_NE(refusal(text).find("3 scene.obj: no geometry"), std::string::npos);
    }
}

TEST(Obj, readsWhatTheParserWouldRejectOrMisread) {
    EXPECT_EQ(read(std::string("\xEF\xBB\xBF").append(kQuad).append("f 1 2 3\n")).faceCount, 1u);
    const SceneData slashes = read(kQuad + "vt 0 0\nf 1/1/ 2/1/ 3/1/ # comment\nf 1// 2// 3//\n");
    EXPECT_EQ(slashes.faceCount, 2u);
    EXPECT_EQ(slashes.meshes[0].uvIndices[0], 0u);
    EXPECT_EQ(slashes.meshes[0].uvIndices[3], kNoIndex);
    EXPECT_EQ(read(kQuad + "f 1 2 \\\n3 \\\n4").meshes[0].faceSizes[0], 4u);
    EXPECT_EQ(read("v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nf 1 2 3\r\n").faceCount, 1u);
}

TEST(Obj, keepsPolygonsOfMoreThan255Corners) {
    std::string text, face = "f";
    for (int i = 1; i <= 300; ++i) {
        text.append("v ").append(std::to_string(i)).append(" 0 0\n");
        face.append(" ").append(std::to_string(i));
    }
    const SceneData scene = read(text + face + "\nf 1 2 3\n");
    EXPECT_EQ(scene.meshes[0].faceSizes, (std::vector<std::uint32_t>{300, 3}));
    EXPECT_EQ(scene.meshes[0].indices.size(), 303u);
}

TEST(Obj, countsWhatIsLeftOut) {
    Heard heard;
    const SceneData scene =
        readObj(kQuad + "l 1 2\np 1\nf 1 2\nf 1 2 3\nvn nan 0 0\n", "scene.obj", ".", heard.sink);
    EXPECT_EQ(scene.faceCount, 1u);
    EXPECT_TRUE(heard.has(Warning::kGeometry, "scene.obj:5: 2 lines, points"));
    EXPECT_TRUE(heard.has(Warning::kGeometry, "scene.obj:7: 1 faces of fewer than 3 corners"));
    EXPECT_TRUE(heard.has(Warning::kGeometry, "scene.obj:9: 1 normals"));
}

TEST(Obj, aNormalOfLengthZeroIsNone) {
    const SceneData scene = read(kQuad + "vn 0 0 0\nvn 0 0 1\nf 1//1 2//2 3//2\n");
    EXPECT_EQ(scene.meshes[0].normalIndices, (std::vector<std::uint32_t>{kNoIndex, 0, 0}));
}

// A normal with one number that is none is none, and counts once.
TEST(Obj, badNormalsAreNoneAndCountOnce) {
    Heard heard;
    const SceneData scene = readObj(kQuad + "vn nan nan 1\nvn 0 0 1\nvn 0 -0 0\nf 1//1 2//2 3//3\n",
                                    "scene.obj", ".", heard.sink);
    EXPECT_EQ(scene.meshes[0].normalIndices, (std::vector<std::uint32_t>{kNoIndex, 0, kNoIndex}));
    EXPECT_TRUE(heard.has(Warning::kGeometry, "scene.obj:5: 1 normals that are not numbers"));
    EXPECT_TRUE(heard.has(Warning::kGeometry, "scene.obj:7: 1 normals of length 0 left out"));
}

TEST(Obj, groupsBecomeMeshesWithMaterialSlots) {
    Heard heard;
    const SceneData scene =
        readObj(kQuad + "o a\nusemtl red one\nf 1 2 3\nusemtl b\nf 1 3 4\ng c\nf 2 3 4\n",
                "scene.obj", ".", heard.sink);
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(scene.meshes[0].slotMaterials, (std::vector<std::uint32_t>{0, 1}));
    EXPECT_EQ(scene.meshes[0].faceSlots, (std::vector<std::uint32_t>{0, 1}));
    EXPECT_EQ(scene.meshes[1].slotMaterials, std::vector<std::uint32_t>{1});
    EXPECT_EQ(scene.materials[0].name, "red one");
    EXPECT_TRUE(heard.has(Warning::kMaterialName, "scene.obj:6: in no library"));
    EXPECT_TRUE(heard.has(Warning::kMaterialName, "'red one', 'b'"));
}

TEST(Obj, statementsWithoutANameAreWarnedOf) {
    Heard heard;
    const SceneData scene =
        readObj("mtllib\n" + kQuad + "usemtl\nf 1 2 3\nusemtl \t\nf 1 3 4\nmtllib \n", "scene.obj",
                ".", heard.sink);
    EXPECT_EQ(scene.meshes[0].slotMaterials, std::vector<std::uint32_t>{0});
    EXPECT_EQ(scene.materials[0].diffuse[0], 0.8f);
    ASSERT_EQ(heard.list.size(), 2u);
    EXPECT_TRUE(
        heard.has(Warning::kGeometry, "scene.obj:1: 2 mtllib lines without a file name left out"));
    EXPECT_TRUE(heard.has(Warning::kMaterialName,
                          "scene.obj:6: usemtl without a name, so a grey of 0.8 is taken"));
}

// What changes no triangle is passed over; all else is told, also where nothing else is there.
TEST(Obj, statementsThatAreNotUnderstoodAreWarnedOf) {
    Heard heard;
    readObj("s off\nvp 1\nlod 1\ncall a.obj\nF 1 2 3\n" + kQuad + "f 1 2 3\n", "scene.obj", ".",
            heard.sink);
    ASSERT_EQ(heard.list.size(), 1u);
    EXPECT_EQ(heard.list[0].second,
              "scene.obj:4: 2 statements that are not understood, 'call' the first, left out");
    EXPECT_NE(refusal(kQuad + "F\xE9 1 2 3\n")
                  .find("0 faces, and 1 statements that are not "
                        "understood, 'F?' the first"),
              std::string::npos);
}

// Of lamps, not of other materials, and only where all faces of a group are without area.
TEST(Obj, lampsWithoutAreaAreWarnedOf) {
    SceneData scene =
        read(kQuad + "g a\nusemtl lamp\nf 1 1 2\nf 1 2 3\ng b\nf 1 2 2 1\nusemtl wall\nf 1 1 2\n");
    scene.materials.at(0).emission = {0, 0, 1};
    Heard heard;
    warnOfLampsWithoutArea(scene, "scene.obj", heard.sink);
    ASSERT_EQ(heard.list.size(), 1u);
    EXPECT_EQ(heard.list[0].second,
              "scene.obj: group b: the faces of material lamp have no area, so this lamp gives no "
              "light");
}

TEST(Obj, tagsBelongToTheirGroup) {
    const SceneData scene = read(kQuad +
                                 "g plain\nf 1 2 3\ng tagged\nf 1 2 3 4\n"
                                 "t crease 3/1/0 0 1 2 2.5\nt corner 1/1/0 3 20\n"
                                 "t interpolateboundary 1/0/0 2\nt hole 1/0/0 1\n"
                                 "t facevaryinginterpolateboundary 1/0/0 5\n");
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_FALSE(scene.meshes[0].tags);
    ASSERT_TRUE(scene.meshes[1].tags);
    const CageTags& tags = *scene.meshes[1].tags;
    EXPECT_EQ(tags.creases, (std::vector<std::uint32_t>{0, 1, 1, 2}));
    EXPECT_EQ(tags.creaseSharpness, (std::vector<float>{2.5f, 2.5f}));
    EXPECT_EQ(tags.corners, std::vector<std::uint32_t>{3});
    EXPECT_EQ(tags.cornerSharpness, std::vector<float>{10.0f});
    EXPECT_EQ(tags.holes, std::vector<std::uint32_t>{0});
    EXPECT_EQ(tags.boundary, 2);
    EXPECT_EQ(tags.faceVarying, 5);
}

TEST(Obj, refusesTagsOutOfRange) {
    EXPECT_TRUE(refusal(kQuad + "f 1 2 3\nt crease 2/1/0 0 3 1\n").starts_with("3 scene.obj:6:"));
    EXPECT_TRUE(refusal(kQuad + "f 1 2 3\nt hole 1/0/0 7\n").starts_with("3 scene.obj:6:"));
    EXPECT_TRUE(refusal(kQuad + "f 1 2 3\nt corner 1/x/0 7\n").starts_with("3 scene.obj:6:"));
    EXPECT_TRUE(refusal(kQuad + "f 1 2 3\nt facevaryinginterpolateboundary 1/0/0 6\n")
                    .starts_with("3 scene.obj:6:"));
}

TEST(Obj, aCommaLocaleChangesNothing) {
    const std::string before = std::setlocale(LC_ALL, nullptr);
    for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE"}) {
        if (std::setlocale(LC_ALL, name) != nullptr) break;
    }
    const std::locale old = std::locale::global(std::locale(std::locale(), new CommaPoint));
    const SceneData scene = read("v 0.5 0 0\nv 1.25 0 0\nv 1 1.75 2345\nf 1 2 3\n");
    std::locale::global(old);
    std::setlocale(LC_ALL, before.c_str());
    // The parser is off by a last bit here and there.
    EXPECT_DOUBLE_EQ(scene.bounds.high[0], 1.25);
    EXPECT_DOUBLE_EQ(scene.bounds.high[1], 1.75);
    EXPECT_DOUBLE_EQ(scene.bounds.high[2], 2345);
}

// Reading asks again and again whether to go on, in its own pass over the text and in the parser's.
TEST(Obj, readingIsGivenUpAtAnyMoment) {
    struct Stopped {};
    std::string text = kQuad;
    for (int i = 0; i < 40000; ++i) text += "f 1 2 3 4\n";
    Heard heard;
    int questions = 0;
    readObj(text, "scene.obj", ".", heard.sink, [&] { ++questions; });
    EXPECT_GE(questions, 8);
    for (int last = 1; last <= questions; ++last) {
        int asked = 0;
        const auto goOn = [&] {
            if (++asked == last) throw Stopped();
        };
        EXPECT_THROW(readObj(text, "scene.obj", ".", heard.sink, goOn), Stopped);
        EXPECT_EQ(asked, last);
    }
}

// A piece of text is checked beside the parser, which reads the one before.
TEST(Obj, piecesThatAreReadBesideTheParserAreTheSame) {
    std::string text = kQuad;
    for (int i = 0; i < 40000; ++i)
        text += fmt::format("v {} 1 {}\nusemtl m{}\nf 1 2 3 {}\n", i, i % 7, i % 101, i + 5);
    Heard heard;
    ReadRules rules;
    const SceneData alone = readObj(text, "scene.obj", ".", heard.sink, {}, {}, rules);
    rules.threads = 2;
    const SceneData beside = readObj(text, "scene.obj", ".", heard.sink, {}, {}, rules);
    ASSERT_EQ(alone.meshes.size(), beside.meshes.size());
    EXPECT_EQ(alone.materials.size(), 102u);
    for (std::size_t i = 0; i < alone.meshes.size(); ++i) {
        EXPECT_EQ(alone.meshes[i].positions, beside.meshes[i].positions);
        EXPECT_EQ(alone.meshes[i].indices, beside.meshes[i].indices);
        EXPECT_EQ(alone.meshes[i].faceSlots, beside.meshes[i].faceSlots);
        EXPECT_EQ(alone.meshes[i].slotMaterials, beside.meshes[i].slotMaterials);
    }
    const std::string error = errorOf(
        [&] { readObj(text + "v nan 0 0\n" + text, "scene.obj", ".", heard.sink, {}, {}, rules); });
    EXPECT_NE(error.find("scene.obj:120005: vertex coordinate 'nan'"), error.npos) << error;
}

TEST(Obj, missingFilesAreErrorsThatNameThem) {
    Heard heard;
    EXPECT_EQ(errorOf([&] { readObjFile("no/such.obj", heard.sink); }),
              "4 no/such.obj: can't be read: No such file or directory");
    EXPECT_NE(errorOf([&] { readObjFile("/", heard.sink); }).find("3 /: no geometry"),
              std::string::npos);
}

}  // namespace
}  // namespace pm::host::test
