// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// MTL sections to materials, as section by section.
#include <gtest/gtest.h>

#include <string>

#include "host_shim/formats/mtl/material_checks.h"
#include "host_shim/formats/mtl/materials.h"
#include "tests/ingest/heard.h"

namespace pm::host::test {
namespace {

using Colour = std::array<float, 3>;

struct Result {
    MaterialData material;
    Heard heard;
};

Result read(const std::string& statements) {
    Result result;
    SceneFiles files("folder", {});
    const auto all =
        readMaterials("newmtl m\n" + statements, {"a.mtl", "folder", {}}, files, result.heard.sink);
    result.material = all.at("m");
    return result;
}

TEST(Material, diffuseAndGlossy) {
    const Result r = read("Kd 0.5 0.4 0.3\nKs 0.2 0.2 0.2\nNs 40\nillum 2\n");
    EXPECT_EQ(r.material.kind, MaterialKind::kSurface);
    EXPECT_EQ(r.material.diffuse, (Colour{0.5f, 0.4f, 0.3f}));
    EXPECT_EQ(r.material.glossy, (Colour{0.2f, 0.2f, 0.2f}));
    EXPECT_EQ(r.material.glossyExponent, 40.0f);
    EXPECT_TRUE(r.heard.list.empty());
}

// By hand nothing else says that it is glass; black paint of a program stays black.
TEST(Material, tfBesideKd0IsClear) {
    for (const char* glass :
         {"Kd 0 0 0\nTf 1 1 1\n", "Kd 0 0 0\nTf 1 1 1\nNi 1.5\n", "Kd 0 0 0\nTf 1 1 1\nPr 0\n",
          "Kd 0 0 0\nTf 1 1 1\nPr 0.2\nNi 1.4\nd 1\n", "Kd 0 0 0\nTf 1 1 1\nNi 1.5\nillum 2\n",
          "Kd 0 0 0\nKs 1 1 1\nTf 1 1 1\nNi 1.33\n"}) {
        const Result r = read(glass);
        EXPECT_EQ(r.material.kind, MaterialKind::kDielectric) << glass;
        EXPECT_EQ(r.material.transmission, (Colour{1, 1, 1})) << glass;
    }
    EXPECT_EQ(read("Kd 0 0 0\nTf 0.9 0.5 0.6\nPr 0.1\n").material.transmission,
              (Colour{0.9f, 0.5f, 0.6f}));
    for (const char* paint : {"Kd 0 0 0\nTf 0 0 0\n", "Kd 0.1 0 0\nTf 1 1 1\n",
                              "Kd 0 0 0\nKs 0 0 0\nTf 1 1 1\nNi 1.5\nillum 2\nd 1\n",
                              "Kd 0 0 0\nKs 0.5 0.5 0.5\nTf 1 1 1\nNi 1.5\nillum 2\n",
                              "Kd 0 0 0\nKe 5 5 5\nTf 1 1 1\n"})
        EXPECT_EQ(read(paint).material.kind, MaterialKind::kSurface) << paint;
}

TEST(Material, noLobeWithoutAnExponentOrWithIllum1) {
    EXPECT_EQ(read("Kd 0.5 0.5 0.5\nKs 0.2 0.2 0.2\n").material.glossy, Colour{});
    EXPECT_EQ(read("Kd 0.5 0.5 0.5\nKs 0.2 0.2 0.2\nNs 9\nillum 1\n").material.glossy, Colour{});
    EXPECT_EQ(read("Kd 0.5 0.5 0.5\nKs 1 1 1\nNs 9\nillum 1\n").heard.list.size(), 0u);
}

TEST(Material, mirrors) {
    const Result rough = read("Ks 0.9 0.8 0.7\nNs 100\nillum 3\n");
    EXPECT_EQ(rough.material.kind, MaterialKind::kMirror);
    EXPECT_FALSE(rough.material.fresnel);
    EXPECT_EQ(rough.material.glossyExponent, 100.0f);
    EXPECT_EQ(read("Ks 0.9 0.9 0.9\nillum 3\n").material.glossyExponent, 0.0f);
    const Result fresnel = read("Kd 0.01 0.01 0.01\nKs 0.95 0.95 0.95\nNs 1024\nillum 5\n");
    EXPECT_EQ(fresnel.material.kind, MaterialKind::kMirror);
    EXPECT_TRUE(fresnel.material.fresnel);
    EXPECT_EQ(fresnel.material.glossyExponent, 0.0f);
    EXPECT_EQ(read("Kd 0.5 0.5 0.5\nillum 3\n").material.kind, MaterialKind::kSurface);
}

TEST(Material, dielectrics) {
    for (const char* illum : {"4", "6", "7"}) {
        const Result r = read(std::string("Ni 1.33\nillum ") + illum + "\n");
        EXPECT_EQ(r.material.kind, MaterialKind::kDielectric);
        EXPECT_EQ(r.material.ior, 1.33f);
        EXPECT_EQ(r.material.transmission, (Colour{1, 1, 1}));
        // Grey is for materials of which nothing is said: here none was left out.
        EXPECT_FALSE(r.heard.has(Warning::kMaterialPart, "diffuse part"));
    }
    EXPECT_TRUE(read("Kd 0.5 0.5 0.5\nNi 1.33\nillum 7\n")
                    .heard.has(Warning::kMaterialPart, "diffuse part of a glass"));
    const Result tinted = read("d 0.2\nNi 1.5\nTf 0.9 0.8 0.7\n");
    EXPECT_EQ(tinted.material.kind, MaterialKind::kDielectric);
    EXPECT_EQ(tinted.material.transmission, (Colour{0.9f, 0.8f, 0.7f}));
    EXPECT_EQ(tinted.material.transparency, 0.0f);
    EXPECT_EQ(read("Tr 0.5\nNi 1.5\n").material.kind, MaterialKind::kDielectric);
    EXPECT_TRUE(read("illum 7\n").heard.has(Warning::kMaterialValue, "without Ni"));
}

TEST(Material, transparencyWithoutAnIndexOfRefraction) {
    EXPECT_FLOAT_EQ(read("Kd 1 1 1\nd 0.25\n").material.transparency, 0.75f);
    EXPECT_FLOAT_EQ(read("Kd 1 1 1\nd 0.25\nNi 1\n").material.transparency, 0.75f);
    EXPECT_FLOAT_EQ(read("Kd 1 1 1\nTr 0.75\n").material.transparency, 0.75f);
    // d wins over Tr, whichever comes first.
    EXPECT_FLOAT_EQ(read("Kd 1 1 1\nTr 1\nd 1\n").material.transparency, 0.0f);
    EXPECT_FLOAT_EQ(read("Kd 1 1 1\nd 1\nTr 1\n").material.transparency, 0.0f);
}

TEST(Material, valuesOutOfRangeAreClampedWithTheLine) {
    const Result r = read("Kd 1.5 -0.5 0.5\n");
    EXPECT_EQ(r.material.diffuse, (Colour{1, 0, 0.5f}));
    EXPECT_TRUE(r.heard.has(Warning::kMaterialValue, "a.mtl:2: material m: Kd 1.5 -0.5 0.5"));
    EXPECT_TRUE(
        read("Kd 0.5 0.2 # two\n").heard.has(Warning::kMaterialValue, "'Kd 0.5 0.2 # two'"));
    EXPECT_EQ(read("Kd 0.5\n").material.diffuse, (Colour{0.5f, 0.5f, 0.5f}));
    EXPECT_TRUE(read("Kd nan 0 0\n").heard.has(Warning::kMaterialValue, "'Kd nan 0 0'"));
    EXPECT_EQ(read("Ke -1 2 3\n").material.emission, (Colour{0, 2, 3}));
    EXPECT_TRUE(read("Ke -1 2 3\n").heard.has(Warning::kMaterialValue, "Ke -1 is not in [0, "));
    const Result infinite = read("Ke 1e39 2 3\n");
    EXPECT_EQ(infinite.material.emission, (Colour{0, 2, 3}));
    EXPECT_TRUE(infinite.heard.has(Warning::kMaterialValue, "Ke inf is not in [0, "));
}

TEST(Material, whatIsUnknownOrNotRenderedIsSaid) {
    EXPECT_TRUE(read("Kdd 0.5 0.5 0.5\n")
                    .heard.has(Warning::kMaterialValue, "a.mtl:2: material m: 'Kdd 0.5 0.5 0.5'"));
    EXPECT_TRUE(read("refl -type sphere s.png\n")
                    .heard.has(Warning::kMaterialPart, "mirrors show the scene, not a picture"));
    EXPECT_TRUE(
        read("illum 11\n").heard.has(Warning::kMaterialValue, "illum 11 is outside [0, 10]"));
    // What exporters write and nobody misses.
    const Result usual = read(
        "Ka 1 1 1\nKd 0.5 0.5 0.5\nillum 2\nsharpness 60\naniso 0\nanisor 0\nPcr 0\nTf 1 1 1\n");
    EXPECT_TRUE(usual.heard.list.empty()) << usual.heard.list.front().second;
}

TEST(Material, layersOfPhysicallyBasedMaterials) {
    const Result r =
        read("Kd 0.5 0.5 0.5\nPr 0.3\nPm 0\nPs 0.4\nPc 1\nPcr 0.2\naniso 0.7\nanisor 0.5\n");
    EXPECT_EQ(r.material.roughness, 0.3f);
    EXPECT_EQ(r.material.sheen, (Colour{0.4f, 0.4f, 0.4f}));
    EXPECT_EQ(r.material.coat, 1.0f);
    EXPECT_EQ(r.material.coatRoughness, 0.2f);
    EXPECT_EQ(r.material.anisotropy, 0.7f);
    EXPECT_EQ(r.material.anisotropyRotation, 0.5f);
    EXPECT_TRUE(r.heard.list.empty());
    EXPECT_TRUE(read("Kd 1 1 1\nPc 2\n").heard.has(Warning::kMaterialValue, "Pc 2 is outside"));
    EXPECT_TRUE(read("Ks 1 1 1\nillum 3\nPs 1\n")
                    .heard.has(Warning::kMaterialPart, "Ps is not rendered on a mirror"));
    EXPECT_TRUE(read("Kd 1 1 1\nKs 0.1 0.1 0.1\nNs 9\naniso 1\n")
                    .heard.has(Warning::kMaterialPart, "with a roughness (Pr) alone"));
}

// Of what only has a number, all pictures in one line.
TEST(Material, picturesOfNumbersAreToldOnce) {
    const Result r = read("Kd 0.5 0.5 0.5\nmap_Pc c.png\nPc 0.5\nmap_Ps s.png\nmap_aniso a.png\n");
    EXPECT_EQ(r.heard.list.size(), 1u);
    EXPECT_TRUE(
        r.heard.has(Warning::kMaterialPart, "map_Ps (Ps 0), map_Pc (Pc 0.5), map_aniso (aniso 0)"));
    EXPECT_EQ(r.material.coat, 0.5f);
}

TEST(Material, bumpMaps) {
    for (const char* key : {"bump", "map_bump", "map_Bump"}) {
        const Result r = read(std::string(key) + " -bm 0.02 -s 2 2 b.png\n");
        ASSERT_TRUE(r.material.bumpTexture) << key;
        EXPECT_EQ(r.material.bumpTexture->file, "folder/b.png");
        EXPECT_TRUE(r.material.bumpTexture->isData);
        EXPECT_EQ(r.material.bumpTexture->strength, 0.02f);
        EXPECT_TRUE(r.heard.list.empty());
    }
    EXPECT_EQ(read("bump -bm -2 b.png\n").material.bumpTexture->strength, -2.0f);
    EXPECT_TRUE(
        read("bump -bm 1e9 b.png\n").heard.has(Warning::kMaterialValue, "is outside [-1000000"));
}

TEST(Material, oneLineForAllChannels) {
    const Result r = read("Ke -1 2 -3\n");
    EXPECT_EQ(r.heard.list.size(), 1u);
    EXPECT_TRUE(r.heard.has(Warning::kMaterialValue, "Ke -1 -3 is not in"));
}

TEST(Material, noSurfaceReflectsMoreThanItGets) {
    const Result r = read("Kd 0.8 0.8 0.8\nKs 1 1 1\nNs 250\nillum 2\n");
    EXPECT_FLOAT_EQ(r.material.diffuse[0] + r.material.glossy[0], 1.0f);
    EXPECT_FLOAT_EQ(r.material.diffuse[0] / r.material.glossy[0], 0.8f);
    EXPECT_TRUE(r.heard.has(Warning::kMaterialValue, "Kd + Ks"));
}

TEST(Material, normalMaps) {
    const Result r = read("norm -bm 0.5 -s 2 2 n.png\n");
    ASSERT_TRUE(r.material.normalTexture);
    EXPECT_EQ(r.material.normalTexture->file, "folder/n.png");
    EXPECT_TRUE(r.material.normalTexture->isData);
    EXPECT_EQ(r.material.normalTexture->strength, 0.5f);
    EXPECT_EQ(r.material.normalTexture->scale, (std::array<float, 2>{2, 2}));
    EXPECT_EQ(read("map_Kn n.png\n").material.normalTexture->strength, 1.0f);
    EXPECT_TRUE(read("norm -bm -2 n.png\n")
                    .heard.has(Warning::kMaterialValue, "-bm -2 is outside [0, 100]"));
    EXPECT_FALSE(read("map_bump b.png\n").material.normalTexture) << "that is a height";
}

TEST(Material, maps) {
    const Result r = read(
        "map_Kd -s 2 3 -o 0.5 -mm 0.1 0.5 -clamp on -colorspace sRGB my wood.png\n"
        "map_d alpha.png\nmap_bump -bm 3 b.png\n");
    ASSERT_TRUE(r.material.diffuseTexture);
    const TextureUse& use = *r.material.diffuseTexture;
    EXPECT_EQ(use.file, "folder/my wood.png");
    EXPECT_EQ(use.scale, (std::array<float, 2>{2, 3}));
    EXPECT_EQ(use.offset, (std::array<float, 2>{0.5f, 0}));
    EXPECT_FLOAT_EQ(use.base, 0.1f);
    EXPECT_FLOAT_EQ(use.gain, 0.5f);
    EXPECT_TRUE(use.clamp);
    EXPECT_EQ(use.colourSpace, "sRGB");
    EXPECT_FALSE(use.isData);
    EXPECT_TRUE(r.material.opacityTexture->isData);
    EXPECT_EQ(r.material.diffuse, (Colour{1, 1, 1}));
    EXPECT_EQ(r.material.bumpTexture->strength, 3.0f);
    EXPECT_EQ(read("Kd 0.5 0.5 0.5\nmap_Kd a.png\n").material.diffuse, (Colour{0.5f, 0.5f, 0.5f}));
    EXPECT_EQ(read("illum 7\nNi 1.5\nmap_Tf a.png\n").material.transmissionTexture->file,
              "folder/a.png");
}

TEST(Material, mapsKnowWhereTheyStand) {
    const Result r =
        read("Kd 1 1 1\nmap_Kd a.png\nmap_opacity b.png\nillum 4\nNi 1.5\nmap_Kt c.png\n");
    EXPECT_EQ(r.material.opacityTexture->place, "a.mtl:4");
    EXPECT_EQ(r.material.transmissionTexture->place, "a.mtl:7");
    EXPECT_EQ(read("map_Kd a.png\n").material.diffuseTexture->place, "a.mtl:2");
}

TEST(Material, mapsWithoutAFileAndOptionsLeftOutAreWarnedOf) {
    const Result r = read(
        "map_Kd\nmap_Ks -s 2 2\nmap_d -t 1 a.png\nmap_Ke -imfchan r a.png\n"
        "norm -imfchan r a.png\nmap_Pr -imfchan g a.png\n");
    EXPECT_EQ(r.heard.list.size(), 5u);
    for (const char* text :
         {"a.mtl:2: material m: map_Kd names no file", "a.mtl:3: material m: map_Ks names no file",
          "a.mtl:5: material m: the option -imfchan of map_Ke", "the option -t of map_d",
          "a.mtl:6: material m: the option -imfchan of norm"})
        EXPECT_TRUE(r.heard.has(Warning::kTexture, text)) << text;
}

TEST(Material, mapsOfNoKnownNameAreWarnedOf) {
    const Result r = read("map_Ks b.png\nmap_xy a.png\nmap_aat on\n");
    EXPECT_TRUE(r.heard.has(Warning::kMaterialValue, "a.mtl:3: material m: 'map_xy a.png' is not"));
    EXPECT_EQ(r.heard.list.size(), 1u);
}

TEST(Material, aLoneNumberIsGrey) {
    EXPECT_EQ(read("Kd 0.5\n").material.diffuse, (Colour{0.5f, 0.5f, 0.5f}));
}

TEST(Material, oneSectionSaysNothingAboutTheNext) {
    Heard heard;
    SceneFiles files(".", {});
    const auto all = readMaterials(
        "newmtl a\nKd 0.1 0.1 0.1\nnewmtl b c\nmap_Kd x.png\n"
        "newmtl a\nKd 1 1 1\nnewmtl e\n",
        {"a.mtl", ".", {}}, files, heard.sink);
    EXPECT_EQ(all.size(), 3u);
    EXPECT_EQ(all.at("b c").diffuse, (Colour{1, 1, 1}));
    EXPECT_EQ(all.at("a").diffuse, (Colour{0.1f, 0.1f, 0.1f}));
    EXPECT_EQ(all.at("e").diffuse, (Colour{0.8f, 0.8f, 0.8f}));
    EXPECT_TRUE(heard.has(Warning::kMaterialValue, "a.mtl:5: material a is defined twice"));
}

// Libraries are shared by many models: what is wrong with materials that this one has not is noise.
TEST(Material, onlyThoseInUseAreReadAndWarnedOf) {
    const std::string text = "newmtl a\nKd 2 2 2\nnewmtl b\nKd 3 3 3\nnewmtl b\nKd 1 1 1\n";
    const std::set<std::string> used = {"a", "not there"};
    Heard heard;
    const auto isUsed = [&used](const std::string& name) { return used.contains(name); };
    SceneFiles files(".", {});
    const MtlSource source{"a.mtl", ".", {}};
    const auto some = readMaterials(text, source, files, heard.sink, isUsed);
    EXPECT_EQ(some.size(), 1u);
    EXPECT_TRUE(heard.has(Warning::kMaterialValue, "material a: Kd 2 2 2"));
    EXPECT_FALSE(heard.has(Warning::kMaterialValue, "material b"));
    Heard all;
    EXPECT_EQ(readMaterials(text, source, files, all.sink).size(), 2u);
    EXPECT_TRUE(all.has(Warning::kMaterialValue, "material b: Kd 3 3 3"));
}

TEST(Material, whatMakesGlassBlackIsSaid) {
    const Result water = read("Ni 1.33\nillum 7\nTf 0.1 0.1 0.1\n");
    EXPECT_TRUE(water.heard.has(Warning::kMaterialValue,
                                "a.mtl:4: material m: this glass lets 0.1 through at each boundary "
                                "and 0.01 at two, so it looks black (Tf 1 1 1 is clear)"));
    EXPECT_TRUE(read("Ni 1.5\nillum 4\nTf 0 0 0\n")
                    .heard.has(Warning::kMaterialValue, "lets nothing through, so it is black"));
    // Bottles may be green.
    EXPECT_TRUE(read("Ni 1.5\nillum 4\nTf 0.05 0.5 0.05\n").heard.list.empty());
    EXPECT_TRUE(read("Kd 200 10 0\n").heard.has(Warning::kMaterialValue, "divided by 255"));
    EXPECT_FALSE(read("Kd 1.2 1 0\n").heard.has(Warning::kMaterialValue, "divided by 255"));
}

// Of a scene as a whole: one such material among others is as it was made.
TEST(Material, thatShowNothingTogetherAreWarnedOf) {
    const auto heardOf = [](const std::vector<std::string>& sections) {
        std::vector<MaterialData> materials;
        for (const std::string& section : sections) materials.push_back(read(section).material);
        Heard heard;
        warnOfUnlikelyMaterials(materials, "s.obj", heard.sink);
        return heard.list.empty() ? "" : heard.list[0].second;
    };
    const std::string lamp = "Kd 0 0 0\nKe 1 1 1\n", red = "Kd 1 0 0\n";
    EXPECT_EQ(heardOf({lamp, red, "Kd 0 0 0\n", "Kd 1 1 1\nTr 1\n", "illum 4\nNi 1\n"}), "");
    EXPECT_EQ(heardOf({lamp}), "");
    EXPECT_EQ(heardOf({}), "");
    const std::string cut = heardOf({lamp, "Kd 1 1 1\nTr 1\n", "Kd 1 1 1\nd 0\n"});
    EXPECT_TRUE(cut.starts_with("s.obj: all 2 materials that give no light: fully transparent"));
    EXPECT_NE(cut.find("write d 1 into the MTL file"), cut.npos);
    EXPECT_NE(heardOf({"illum 4\nNi 1.00\nTf 1 1 1\nKd 1 0 0\n"}).find("--mtl-dialect maya"),
              std::string::npos);
    EXPECT_NE(heardOf({lamp, "Kd 0 0 0\n", "Kd 0 0 0\nKs 0.5 0.5 0.5\n"}).find("black, so only"),
              std::string::npos);
    EXPECT_EQ(heardOf({"Kd 0 0 0\nKs 0.5 0.5 0.5\nNs 10\n"}), "");
}

}  // namespace
}  // namespace pm::host::test
