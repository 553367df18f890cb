// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The manifest of a packed scene, and where files lie in a pack.
#include "host_shim/copies/manifest.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "host_shim/copies/pack_places.h"
#include "host_shim/copies/sha256.h"
#include "host_shim/values/host_error.h"

namespace pm::host::test {
namespace {

namespace fs = std::filesystem;

Manifest small() {
    Manifest manifest;
    manifest.scene = "shots/a.obj";
    manifest.base = "/project";
    manifest.folders = {"models"};
    manifest.searchPaths = {"tex", "."};
    manifest.environment = {"sky \"1\".hdr", "tex/sky.hdr"};
    manifest.files = {{"shots/a.obj", 3, sha256Of("abc")},
                      {"tex/gr\xc3\xbcn.png", 0, sha256Of("")},
                      {"tex/sky.hdr", 3, sha256Of("abc")}};
    return manifest;
}

TEST(Manifest, ComesBackAsItWas) {
    const Manifest manifest = small();
    const Manifest again = Manifest::fromJson(manifest.toJson(), "x");
    EXPECT_EQ(again.toJson(), manifest.toJson());
    EXPECT_EQ(again.scene, "shots/a.obj");
    EXPECT_EQ(again.searchPaths, (std::vector<std::string>{"tex", "."}));
    EXPECT_FALSE(again.ocio);
    EXPECT_EQ(again.environment->text, "sky \"1\".hdr");
    EXPECT_EQ(again.files.at(1).place, "tex/gr\xc3\xbcn.png");
    EXPECT_EQ(again.bytes(), 3u) << "what is alike counts once";
    // FIPS 180-4's example.
    EXPECT_EQ(objectPath(again.files.at(0).sha256),
              "objects/ba/ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Manifest, PlacesLeadNowhereElse) {
    for (const char* place : {"a", "a/b", "..a", "a..", "a b/c", ".hidden", "..."})
        EXPECT_TRUE(isPlace(place)) << place;
    for (const char* place :
         {"", ".", "..", "/", "/a", "a/", "a//b", "../a", "a/..", "a/../b", "./a", "a/.", "a/./b"})
        EXPECT_FALSE(isPlace(place)) << place;
    EXPECT_FALSE(isPlace(std::string_view("a\0b", 3)));
    EXPECT_FALSE(isPlace(std::string(5000, 'a')));
}

// Whatever comes from a server is a manifest that holds what it promises, or refused.
TEST(Manifest, DamagedOnesAreRefusedOrWhole) {
    const std::string text = small().toJson();
    std::mt19937 random(7);
    int refused = 0;
    for (int i = 0; i < 3000; ++i) {
        std::string damaged = text;
        for (int flips = 1 + i % 3; flips > 0; --flips)
            damaged[random() % damaged.size()] = static_cast<char>(random() % 256);
        if (i % 5 == 0) damaged.resize(random() % damaged.size());
        try {
            const Manifest manifest = Manifest::fromJson(damaged, "x");
            EXPECT_TRUE(isPlace(manifest.scene));
            for (const PackedFile& file : manifest.files)
                EXPECT_TRUE(isPlace(file.place) && isSha256(file.sha256));
        } catch (const HostError& fault) {
            EXPECT_EQ(fault.code(), ExitCode::kBadInput);
            ++refused;
        }
    }
    EXPECT_GT(refused, 1000);
}

class PackPlacesTest : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string name = ::testing::TempDir() + "pm_places.XXXXXX";
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        m_folder = fs::canonical(name);
        for (const char* file : {"shots/a.obj", "tex/red.png", "elsewhere/red.png"}) {
            fs::create_directories((m_folder / file).parent_path());
            std::ofstream(m_folder / file) << file;
        }
    }
    void TearDown() override {
        std::error_code ignored;
        fs::remove_all(m_folder, ignored);
    }

    fs::path m_folder;
};

TEST_F(PackPlacesTest, KeepFilesToEachOther) {
    fs::create_directories(m_folder / "models/lamps");
    PackPlaces places;
    places.addFile(m_folder / "shots/a.obj");
    places.addFile(m_folder / "shots/../models/lamps/../../tex/red.png");
    places.addFile(m_folder / "tex/red.png");
    EXPECT_EQ(places.base(), m_folder);
    EXPECT_EQ(places.placeOf(m_folder / "shots/a.obj"), "shots/a.obj");
    EXPECT_EQ(places.files().size(), 2u);
    EXPECT_TRUE(places.files().contains("tex/red.png"));
    // So that the way that goes through them can be gone.
    EXPECT_EQ(places.folders(), (std::vector<std::string>{"models", "models/lamps", "shots"}));
    places.addSearchPath(m_folder);
    EXPECT_EQ(places.placeOf(m_folder / ""), ".");
}

TEST_F(PackPlacesTest, BaseIsTheNearestFolder) {
    PackPlaces places;
    places.addFile(m_folder / "shots/a.obj");
    EXPECT_EQ(places.base(), m_folder / "shots");
    places.addSearchPath(m_folder / "shots/more");
    EXPECT_EQ(places.base(), m_folder / "shots");
    EXPECT_EQ(places.placeOf(m_folder / "shots/more/"), "more");
}

TEST_F(PackPlacesTest, TwoFilesOfOnePlaceAreRefused) {
    // ".." behind a link leads to where the link does, not to the folder that it lies in.
    fs::create_directory_symlink(m_folder / "elsewhere", m_folder / "tex/link");
    std::ofstream(m_folder / "red.png") << "another";
    PackPlaces places;
    places.addFile(m_folder / "tex/red.png");
    try {
        places.addFile(m_folder / "tex/link/../red.png");
        FAIL() << "two files";
    } catch (const HostError& fault) {
        EXPECT_EQ(fault.code(), ExitCode::kBadInput);
    }
    EXPECT_THROW(places.addFile(m_folder / "gr\xfcn.png"), HostError);
}

}  // namespace
}  // namespace pm::host::test
