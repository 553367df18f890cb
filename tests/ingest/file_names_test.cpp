// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Names of files in scene files, as people and other systems write them.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "host_shim/formats/scene_files.h"
#include "tests/ingest/heard.h"

namespace pm::host::test {
namespace {

namespace fs = std::filesystem;

class FileNames : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string name = ::testing::TempDir() + "pm_file_names.XXXXXX";
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        m_folder = name;
        fs::create_directories(m_folder / "Maps");
        write("Maps/Wood #2.png", "");
        write("Maps/wood.png", "");
        write("a.mtl", "newmtl red\nKd 0.8 0.1 0.1\nnewmtl Material #25\nKd 0.1 0.2 0.3\n");
    }
    void TearDown() override {
        std::error_code ignored;
        fs::remove_all(m_folder, ignored);
    }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(m_folder / name, std::ios::binary) << text;
    }
    std::string found(std::string_view name) const {
        SceneFiles files(m_folder, {});
        const auto file = files.find(m_folder, name);
        return file ? fs::relative(*file, m_folder).string() : "none";
    }
    SceneData read(const std::string& head, Heard& heard) const {
        write("s.obj", head + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        return readObjFile(m_folder / "s.obj", heard.sink);
    }

    fs::path m_folder;
};

TEST_F(FileNames, AreFoundAsTheyWereMeant) {
    EXPECT_EQ(found("Maps/wood.png"), "Maps/wood.png");
    EXPECT_EQ(found("Maps\\wood.png"), "Maps/wood.png");
    EXPECT_EQ(found("\"Maps/wood.png\""), "Maps/wood.png");
    EXPECT_EQ(found("Maps/wood.png # oak"), "Maps/wood.png");
    EXPECT_EQ(found("Maps/Wood #2.png"), "Maps/Wood #2.png");
    EXPECT_EQ(found("maps/WOOD.PNG"), "Maps/wood.png");
    EXPECT_EQ(found("\".\\MAPS\\Wood.png\"  # oak"), "Maps/wood.png");
    for (const char* none : {"Maps", "Maps/wood.pn", "", "# wood.png", "../wood.png", "\"\""})
        EXPECT_EQ(found(none), "none") << none;
}

// Of two that differ by case only, the one that is named; else always the same one.
TEST_F(FileNames, TheExactNameWins) {
    write("Maps/WOOD.png", "");
    EXPECT_EQ(found("Maps/wood.png"), "Maps/wood.png");
    EXPECT_EQ(found("Maps/WOOD.png"), "Maps/WOOD.png");
    EXPECT_EQ(found("Maps/Wood.png"), "Maps/WOOD.png");
}

TEST_F(FileNames, LibrariesAndMaterialsBeforeAComment) {
    for (const char* library : {"a.mtl", "a.mtl # all of them", "\"a.mtl\"", "A.MTL"}) {
        Heard heard;
        const SceneData scene =
            read(std::string("mtllib ") + library + "\nusemtl red # paint\n", heard);
        EXPECT_FLOAT_EQ(scene.materials.at(0).diffuse[0], 0.8f) << library;
        EXPECT_TRUE(heard.list.empty()) << library << ": " << heard.list.front().second;
    }
    Heard heard;
    const SceneData scene = read("mtllib a.mtl\nusemtl Material #25\n", heard);
    EXPECT_FLOAT_EQ(scene.materials.at(0).diffuse[2], 0.3f);
    read("\nmtllib a.mtl\nmtllib b.mtl # gone\n", heard);
    EXPECT_TRUE(heard.has(Warning::kMaterialFile, "s.obj:3: material library missing: "));
    EXPECT_TRUE(heard.has(Warning::kMaterialFile, "b.mtl: can't be read: No such file"));
    EXPECT_TRUE(heard.has(Warning::kMaterialFile, "; a grey of 0.8 is taken for"));
    read("mtllib Maps\n", heard);
    EXPECT_TRUE(heard.has(Warning::kMaterialFile, "Maps: can't be read: it is a folder"));
    EXPECT_FALSE(heard.has(Warning::kMaterialFile, "gone"));
}

// What looks like a comment belongs to a name that is there, and does not make others used.
TEST_F(FileNames, CommentsBehindTheNamesOfMaterials) {
    write("c.mtl",
          "newmtl lamp # the lamp\nKd 0.25 0 0\nnewmtl Material #1\nKd 2 0 0\n"
          "newmtl Material #2\nKd 0.5 0 0\n");
    Heard heard;
    const SceneData scene =
        read("mtllib c.mtl\nusemtl lamp\nusemtl Material #2\nusemtl Material #3\n", heard);
    EXPECT_EQ(scene.materials.at(0).diffuse[0], 0.25f);
    EXPECT_EQ(scene.materials.at(1).diffuse[0], 0.5f);
    EXPECT_EQ(scene.materials.at(2).diffuse[0], 0.8f);
    ASSERT_EQ(heard.list.size(), 1u);
    EXPECT_TRUE(heard.has(Warning::kMaterialName, "s.obj:4: in no library"))
        << heard.list[0].second;
}

}  // namespace
}  // namespace pm::host::test
