// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Which files the names in scene files lead to, and which they may not lead to.
#include "host_shim/formats/scene_files.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/ingest/heard.h"

namespace pm::host::test {
namespace {

namespace fs = std::filesystem;

// world/scene is the scene's folder, world/library another, world/secret.png lies beside both.
class SceneFilesTest : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string name = ::testing::TempDir() + "pm_scene_files.XXXXXX";
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        m_world = name;
        m_scene = m_world / "scene";
        for (const char* file :
             {"scene/tex/red.png", "scene/blue.png", "library/tex/green.png", "library/blue.png",
              "secret.png", "secret.mtl", "scene/gr\xc3\xbcn.png",
              "scene/Stra\xdf"
              "e.png"})
            write(file, "");
        fs::create_symlink(m_world / "secret.png", m_scene / "link.png");
        fs::create_directory_symlink(m_world, m_scene / "out");
        fs::create_symlink("tex/red.png", m_scene / "inside.png");
    }
    void TearDown() override {
        std::error_code ignored;
        fs::remove_all(m_world, ignored);
    }
    void write(const std::string& name, const std::string& text) const {
        fs::create_directories((m_world / name).parent_path());
        std::ofstream(m_world / name, std::ios::binary) << text;
    }
    std::string found(const SceneFileRules& rules, std::string_view name) const {
        SceneFiles files(m_scene, rules);
        const auto file = files.find(m_scene, name);
        return file ? fs::canonical(*file).lexically_relative(fs::canonical(m_world)).string()
                    : "none";
    }
    std::string found(std::string_view name) const { return found(SceneFileRules{}, name); }

    fs::path m_world, m_scene;
};

TEST_F(SceneFilesTest, TailsOfNamesOfOtherMachines) {
    for (const char* name :
         {"C:\\a\\tex\\red.png", "/home/someone/tex/red.png", "..\\..\\tex\\red.png",
          "..\\..\\models\\tex\\red.png", "//server/share/tex/red.png", "\"D:\\x\\Tex\\RED.png\"",
          "file:/a/tex/red.png", "other/tex/red.png # paint", "textures\\..\\tex\\red.png"})
        EXPECT_EQ(found(name), "scene/tex/red.png") << name;
    EXPECT_EQ(found("C:\\deep\\down\\blue.png"), "scene/blue.png");
    EXPECT_EQ(found("C:\\tex\\white.png"), "none");
    // The longest tail counts.
    write("scene/b/tex/red.png", "");
    EXPECT_EQ(found("C:\\b\\tex\\red.png"), "scene/b/tex/red.png");
    EXPECT_EQ(found("C:\\a\\tex\\red.png"), "scene/tex/red.png");
}

TEST_F(SceneFilesTest, NamesInOtherEncodings) {
    EXPECT_EQ(found("gr\xc3\xbcn.png"), "scene/gr\xc3\xbcn.png");
    EXPECT_EQ(found("gr\xfcn.png"), "scene/gr\xc3\xbcn.png");
    EXPECT_EQ(found("C:\\maps\\GR\xfcN.png"), "scene/gr\xc3\xbcn.png");
    EXPECT_EQ(found("Stra\xc3\x9f"
                    "e.png"),
              "scene/Stra\xdf"
              "e.png");
    EXPECT_EQ(found("gr\x81n.png"), "none");
    EXPECT_EQ(found(std::string_view("blue.png\0x", 10)), "none");
    EXPECT_EQ(found(std::string(100000, 'x')), "none");
}

TEST_F(SceneFilesTest, SearchPathsComeAfterTheScenesFolder) {
    const SceneFileRules rules{{m_world / "library"}, true, {}};
    EXPECT_EQ(found("green.png"), "none");
    EXPECT_EQ(found(rules, "tex/green.png"), "library/tex/green.png");
    EXPECT_EQ(found(rules, "E:\\maps\\tex\\green.png"), "library/tex/green.png");
    EXPECT_EQ(found(rules, "blue.png"), "scene/blue.png");
    const std::string missing = (m_world / "nowhere").string();
    EXPECT_EQ(errorOf([&] {
                  found({{missing}, true, {}}, "a");
              }),
              "4 --search-path " + missing + ": there is no such folder");
}

TEST_F(SceneFilesTest, WhatIsNotTrustedReadsBelowItsFolderOnly) {
    const std::string secret = (m_world / "secret.png").string();
    const SceneFileRules untrusted{{}, false, {}};
    for (const std::string& name :
         {secret, std::string("../secret.png"), std::string("link.png"),
          std::string("out/secret.png"), std::string("tex/../../secret.png"),
          std::string("out/library/tex/green.png"), std::string("..\\secret.png")}) {
        EXPECT_NE(found(name), "none") << name;
        EXPECT_EQ(found(untrusted, name), "none") << name;
    }
    for (const char* name : {"blue.png", "tex/red.png", "inside.png", "tex/../blue.png",
                             "C:\\a\\tex\\red.png", "out/scene/blue.png"})
        EXPECT_NE(found(untrusted, name), "none") << name;
    // An absolute name is as good as another where it leads below the folder.
    EXPECT_EQ(found(untrusted, (m_scene / "blue.png").string()), "scene/blue.png");
    EXPECT_EQ(found({{m_world / "library"}, false, {}}, "green.png"), "none");
    EXPECT_EQ(found({{m_world / "library"}, false, {}}, "tex/green.png"), "library/tex/green.png");
    EXPECT_EQ(
        found({{}, false, {m_world / "library"}}, (m_world / "library/tex/green.png").string()),
        "library/tex/green.png");
    // A folder whose name begins alike is another one.
    write("scene2/x.png", "");
    EXPECT_EQ(found(untrusted, (m_world / "scene2/x.png").string()), "none");
    EXPECT_EQ(found(untrusted, "../scene2/x.png"), "none");
}

TEST_F(SceneFilesTest, AbsoluteNamesOfASceneThatWasMoved) {
    SceneFileRules rules{{}, false, {m_world}};
    rules.moved = {"/project/shots", m_world};
    EXPECT_EQ(found(rules, "/project/shots/library/blue.png"), "library/blue.png");
    EXPECT_EQ(found(rules, "/project/shots/Library/BLUE.png"), "library/blue.png");
    EXPECT_EQ(found(rules, "/project/shots2/secret.png"), "none");
    // What lies on this machine is not meant, nor what its tail would lead to elsewhere.
    EXPECT_EQ(found(rules, (m_world / "library/tex/green.png").string()), "none");
    EXPECT_EQ(found(rules, (m_world / "scene/blue.png").string()), "scene/blue.png") << "its tail";
    EXPECT_EQ(found(rules, "/project/shots/../shots/secret.png"), "none");
}

// Libraries and pictures go the same way, and what is refused is told with its line.
TEST_F(SceneFilesTest, EveryNameOfASceneIsAsked) {
    const std::string geometry = "usemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    write("secret.mtl", "newmtl m\nKd 0.25 0 0\n");
    write("scene/a.obj", "mtllib ../secret.mtl\n" + geometry);
    write("scene/b.mtl", "newmtl m\nKd 0.5 0 0\nmap_Kd ../secret.png\nmap_d inside.png\n");
    write("scene/b.obj", "mtllib b.mtl\n" + geometry);
    ReadRules rules;
    Heard trusted, heard;
    EXPECT_EQ(readObjFile(m_scene / "a.obj", trusted.sink).materials[0].diffuse[0], 0.25f);
    EXPECT_TRUE(readObjFile(m_scene / "b.obj", trusted.sink).materials[0].diffuseTexture);
    EXPECT_TRUE(trusted.list.empty());
    rules.files.isTrusted = false;
    const SceneData a = readObjFile(m_scene / "a.obj", heard.sink, {}, {}, rules);
    EXPECT_EQ(a.materials[0].diffuse[0], 0.8f);
    EXPECT_TRUE(a.materialFiles.empty());
    EXPECT_TRUE(heard.has(Warning::kMaterialFile,
                          "a.obj:1: material library missing: "
                          "'../secret.mtl' is no file below "));
    const SceneData b = readObjFile(m_scene / "b.obj", heard.sink, {}, {}, rules);
    EXPECT_FALSE(b.materials[0].diffuseTexture);
    EXPECT_EQ(b.materials[0].diffuse[0], 0.5f);
    EXPECT_TRUE(b.materials[0].opacityTexture);
    EXPECT_TRUE(
        heard.has(Warning::kTexture, "b.mtl:3: material m: map_Kd: '../secret.png' is no "));
    EXPECT_TRUE(heard.has(Warning::kTexture, "; --untrusted allows no other folder"));
}

// A line of mtllib may be one name or several, each of another machine.
TEST_F(SceneFilesTest, LibrariesOfOtherMachines) {
    write("scene/a.mtl", "newmtl a\nKd 0.25 0 0\n");
    write("scene/lib/b c.mtl", "newmtl b\nKd 0.5 0 0\n");
    const auto read = [this](const std::string& line) {
        write("scene/m.obj", "mtllib " + line +
                                 "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\n"
                                 "f 1 2 3\n");
        Heard heard;
        const SceneData scene = readObjFile(m_scene / "m.obj", heard.sink);
        return std::array{scene.materials[0].diffuse[0], scene.materials[1].diffuse[0]};
    };
    using Pair = std::array<float, 2>;
    EXPECT_EQ(read("C:\\x\\a.mtl D:\\lib\\b\\ c.mtl"), (Pair{0.25f, 0.5f}));
    EXPECT_EQ(read("C:\\x\\a.mtl"), (Pair{0.25f, 0.8f}));
    EXPECT_EQ(read("C:\\my things\\lib\\b c.mtl"), (Pair{0.8f, 0.5f}));
    EXPECT_EQ(read("x/a.mtl none.mtl"), (Pair{0.25f, 0.8f}));
}

TEST_F(SceneFilesTest, DevicesAreNoLibraries) {
    write("scene/d.obj", "mtllib /dev/zero\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    Heard heard;
    readObjFile(m_scene / "d.obj", heard.sink);
    EXPECT_TRUE(heard.has(Warning::kMaterialFile, "/dev/zero: can't be read: it is a device"));
}

TEST_F(SceneFilesTest, MaterialsAndKeysInOtherCase) {
    write("scene/c.mtl",
          "NEWMTL Red Paint\nkd 0.5 0 0\nMAP_KE blue.png -s 2\nnewmtl blue\nKD 0 0 0.5\n"
          "newmtl Blue\nKd 0 0 0.25\n");
    const std::string faces = "f 1 2 3\n";
    write("scene/c.obj", "mtllib c.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red paint\n" + faces +
                             "usemtl Blue\n" + faces + "usemtl BLUE # sky\n" + faces);
    Heard heard;
    const SceneData scene = readObjFile(m_scene / "c.obj", heard.sink);
    EXPECT_TRUE(heard.list.empty()) << heard.list[0].second;
    EXPECT_EQ(scene.materials[0].diffuse[0], 0.5f);
    ASSERT_TRUE(scene.materials[0].emissionTexture);
    EXPECT_EQ(scene.materials[0].emissionTexture->scale[0], 2.0f);
    EXPECT_EQ(scene.materials[0].emission[0], 1.0f);
    EXPECT_EQ(scene.materials[1].diffuse[2], 0.25f);
    EXPECT_GT(scene.materials[2].diffuse[2], 0.0f);
}

}  // namespace
}  // namespace pm::host::test
