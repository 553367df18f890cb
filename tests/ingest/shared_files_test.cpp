// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Files that other people's loaders stumbled over. They lie outside the repository; without them
// the tests are skipped.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "tests/ingest/heard.h"

namespace pm::host::test {
namespace {

namespace fs = std::filesystem;
const fs::path kData = PM_SHARED_DATA;

class SharedFiles : public ::testing::Test {
  protected:
    void SetUp() override {
        if (!fs::exists(kData)) GTEST_SKIP() << "no optional data at " << kData;
    }
};

void checkConsistent(const SceneData& scene, const fs::path& file) {
    for (const MeshData& mesh : scene.meshes) {
        std::uint64_t corners = 0;
        for (const std::uint32_t size : mesh.faceSizes) corners += size;
        ASSERT_EQ(corners, mesh.indices.size()) << file;
        ASSERT_EQ(mesh.faceSlots.size(), mesh.faceSizes.size()) << file;
        for (const std::uint32_t index : mesh.indices) ASSERT_LT(index, mesh.positions.size() / 3);
        for (const std::uint32_t index : mesh.normalIndices) {
            ASSERT_TRUE(index == kNoIndex || index < mesh.normals.size() / 3) << file;
        }
        for (const std::uint32_t index : mesh.uvIndices) {
            ASSERT_TRUE(index == kNoIndex || index < mesh.uvs.size() / 2) << file;
        }
        for (const std::uint32_t slot : mesh.slotMaterials) ASSERT_LT(slot, scene.materials.size());
    }
}

// Every file either reads into something consistent or is refused by name, with a line.
TEST_F(SharedFiles, everyFileReadsOrIsRefusedByName) {
    std::map<std::string, std::string> refused;
    int read = 0;
    for (const auto& entry : fs::recursive_directory_iterator(kData)) {
        if (entry.path().extension() != ".obj") continue;
        Heard heard;
        const std::string error =
            errorOf([&] { checkConsistent(readObjFile(entry.path(), heard.sink), entry.path()); });
        if (error == "no error") {
            ++read;
            continue;
        }
        refused[entry.path().filename().string()] = error;
        EXPECT_TRUE(error.starts_with("3 " + entry.path().string() + ":")) << error;
    }
    EXPECT_GT(read, 60);
    for (const auto& [name, error] : refused) std::cout << name << ": " << error << "\n";
    for (const char* bad : {"invalid-relative-vertex-index.obj", "issue-140-zero-face-idx.obj",
                            "test-nan.obj", "invalid-relative-texture-index.obj"}) {
        EXPECT_TRUE(refused.contains(bad)) << bad;
    }
}

TEST_F(SharedFiles, namesWithBlanks) {
    Heard heard;
    const fs::path folder = kData / "obj-odd/tinyobjloader-models";
    readObjFile(folder / "mtl filename with whitespace issue46.obj", heard.sink);
    EXPECT_FALSE(heard.has(Warning::kMaterialName, ""));
    const SceneData scene = readObjFile(folder / "issue-246-usemtl-whitespace.obj", heard.sink);
    EXPECT_FALSE(heard.has(Warning::kMaterialName, ""));
    EXPECT_GT(scene.faceCount, 0u);
}

TEST_F(SharedFiles, cornellBoxesHaveLightMirrorAndGlass) {
    Heard heard;
    const fs::path folder = kData / "obj-gi/mcguire-cornell";
    const SceneData box = readObjFile(folder / "CornellBox-Sphere.obj", heard.sink);
    EXPECT_TRUE(box.hasLight());
    int mirrors = 0, glasses = 0;
    for (const MaterialData& material : box.materials) {
        mirrors += material.kind == MaterialKind::kMirror ? 1 : 0;
        glasses += material.kind == MaterialKind::kDielectric ? 1 : 0;
    }
    EXPECT_EQ(mirrors, 1);
    EXPECT_EQ(glasses, 1);
}

}  // namespace
}  // namespace pm::host::test
