// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What wrote an MTL file, by its header, and what its numbers mean then.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "host_shim/formats/mtl/coat_albedo.h"
#include "host_shim/formats/mtl/materials.h"
#include "tests/ingest/heard.h"

namespace pm::host::test {
namespace {

namespace fs = std::filesystem;
using Colour = std::array<float, 3>;

std::string dialectOf(std::string_view text) {
    const auto choice = dialectOfHeader(text, "a.mtl");
    return choice ? nameOf(choice->dialect).name : "none";
}

TEST(MtlDialect, IsToldByTheHeader) {
    const std::vector<std::pair<const char*, const char*>> headers{
        {"# Blender 3.4.1 MTL File: 'room.blend'\n# www.blender.org\n\nnewmtl a\n", "blender3"},
        {"# Blender 3.4.1\n# www.blender.org\nmtllib room.mtl\no floor\nv 0 0 0\n", "blender3"},
        {"\xEF\xBB\xBF# Blender 4.2.1 LTS MTL File: 'None'\r\n", "blender4"},
        {"# Blender 10.0.0\n", "blender4"},
        {"# Blender 3.1.2 MTL File: 'None'\n", "blender2.8"},
        {"# Blender v2.92.0 OBJ File: ''\n", "blender2.8"},
        {"# Blender v2.79 (sub 0) OBJ File: 'x.blend'\n", "blender2.7"},
        {"# Blender MTL File: 'None'\n# Material Count: 3\n", "blender2.8"},
        {"# 3ds Max Wavefront OBJ Exporter v0.97b - (c)2007 guruware\n", "3dsmax"},
        {"# Max2Obj Version 4.0 Mar 10th, 2001\n#\n", "3dsmax"},
        {"# This file uses centimeters as units for non-parametric coordinates.\n\nmtllib a.mtl\n"
         "g default\nv 0 0 0\n",
         "maya"},
        {"# The units used in this file are meters.\n", "maya"},
        {"# Rhino\n\nmtllib a.mtl\n", "rhino"},
        {"# Alias OBJ Model File\n# Exported from SketchUp, (c) 2000-2012 Trimble\n", "sketchup"},
        {"#File exported by ZBrush version 3.5\n#www.zbrush.com\n", "zbrush"},
        {"# Default material file.  Created by Morgan McGuire and released into\n", "mcguire"},
        {"#\n# http://graphics.cs.williams.edu/data\nnewmtl a\n", "mcguire"},
        // Of two the first, and none where none is named or where it stands among the numbers.
        {"# 3ds Max Wavefront OBJ Exporter\n# Rhino\n", "3dsmax"},
        {"# converted by hand\nnewmtl a\n", "none"},
        {"# a model of a rhino\nv 0 0 0\n", "none"},
        {"newmtl a\n# Blender 3.4.1\n", "none"},
        {"", "none"},
        {"\n\n#\n# \n", "none"}};
    for (const auto& [text, name] : headers) EXPECT_EQ(dialectOf(text), name) << text;
}

TEST(MtlDialect, EveryNameIsFoundInAnyCase) {
    for (const DialectName& entry : dialectNames()) {
        EXPECT_EQ(dialectByName(entry.name), entry.dialect);
        EXPECT_EQ(nameOf(entry.dialect).name, entry.name);
    }
    EXPECT_EQ(dialectByName("3DSMax"), MtlDialect::k3dsMax);
    EXPECT_FALSE(dialectByName("blender"));
    EXPECT_FALSE(dialectByName(""));
}

struct Result {
    MaterialData material;
    Heard heard;
};

Result read(MtlDialect dialect, const std::string& statements) {
    Result result;
    SceneFiles files("folder", {});
    result.material = readMaterials("newmtl m\n" + statements, {"a.mtl", "folder", dialect}, files,
                                    result.heard.sink)
                          .at("m");
    return result;
}

void expectNear(const Colour& colour, const Colour& right) {
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(colour[i], right[i], 1e-5) << i;
}

constexpr auto kBlender3 = MtlDialect::kBlender3;

// Ks .5 is Blender's usual specular: 4 % at normal incidence, whatever the index of refraction.
TEST(MtlDialect, BlendersPlasticReflectsFourPercent) {
    const Result r = read(kBlender3,
                          "Ns 250\nKa 1 1 1\nKd 0.8 0.1 0.1\nKs 0.5 0.5 0.5\nNi 1.45\nd 1\n"
                          "illum 2\n");
    EXPECT_EQ(r.material.kind, MaterialKind::kSurface);
    expectNear(r.material.glossy, {0.04f, 0.04f, 0.04f});
    // The renderer's coat takes from what is below it, Blender's does not; and the diffuse part of
    // a surface that is half rough reflects .953 + .1122 / 2 in the mean.
    const auto more = static_cast<float>((0.953 + 0.0561) / (1 - meanOfCoat(0.04, 0.5)));
    expectNear(r.material.diffuse, {0.8f * more, 0.1f * more, 0.1f * more});
    EXPECT_NEAR(r.material.roughness, 0.5f, 1e-6);
    EXPECT_TRUE(r.heard.list.empty());
    const Result textured = read(kBlender3, "Ns 250\nmap_Kd -mm 0.1 0.5 a.png\nKs 0.5 0.5 0.5\n");
    expectNear(textured.material.diffuse, {1, 1, 1});
    EXPECT_NEAR(textured.material.diffuseTexture->base, 0.1f * more, 1e-6f);
    EXPECT_NEAR(textured.material.diffuseTexture->gain, 0.5f * more, 1e-6f);
    EXPECT_NEAR(
        read(kBlender3, "Ks 0.25 0.25 0.25\nNs 250\nKd 0.5 0.5 0.5\nillum 2\n").material.glossy[0],
        0.02, 1e-6);
    EXPECT_EQ(read(kBlender3, "Ks 0 0 0\nNs 250\nKd 0.5 0.5 0.5\nillum 1\n").material.glossy,
              Colour{});
}

// Since Blender 4 the index of refraction sets what Ks .5 is.
TEST(MtlDialect, BlenderFourGoesByTheIndexOfRefraction) {
    const auto glossy = [](const char* ni) {
        return read(MtlDialect::kBlender4,
                    std::string("Ns 250\nKd 0.2 0.2 0.2\nKs 0.5 0.5 0.5\n") + ni + "d 1\nillum 2\n")
            .material.glossy[0];
    };
    EXPECT_NEAR(glossy("Ni 1.5\n"), 0.04, 1e-6);
    EXPECT_NEAR(glossy("Ni 2\n"), 1.0 / 9, 1e-6);
    EXPECT_NEAR(glossy("Ni 1\n"), 0, 1e-6);
    const Result plain = read(MtlDialect::kBlender4, "Ns 250\nKd 0.2 0.2 0.2\nNi 1\nillum 2\n");
    expectNear(plain.material.diffuse, {0.2f, 0.2f, 0.2f});
    EXPECT_NEAR(glossy(""), 0.04, 1e-6);
}

TEST(MtlDialect, BlendersMetalsKeepTheirColour) {
    const std::string gold = "Ka 1 1 1\nKd 1 0.77 0.34\nKs 0.5 0.5 0.5\nNi 1.45\nd 1\nillum 3\n";
    const Result rough = read(kBlender3, "Ns 640\n" + gold);
    EXPECT_EQ(rough.material.kind, MaterialKind::kMirror);
    EXPECT_TRUE(rough.material.fresnel);
    expectNear(rough.material.glossy, {1, 0.77f, 0.34f});
    EXPECT_NEAR(rough.material.roughness, 0.2, 1e-6);
    EXPECT_TRUE(rough.heard.list.empty());
    const Result smooth = read(kBlender3, "Ns 1000\n" + gold);
    EXPECT_TRUE(smooth.material.fresnel);
    EXPECT_EQ(smooth.material.roughness, 0.0f);
    expectNear(smooth.material.glossy, {1, 0.77f, 0.34f});
    // Half of it metal, and the same by the keys for physically based materials.
    const Colour half{0.5f + 0.02f, 0.385f + 0.02f, 0.17f + 0.02f};
    const Result mixed = read(kBlender3,
                              "Ns 640\nKa 0.5 0.5 0.5\nKd 1 0.77 0.34\nKs 0.5 0.5 0.5\n"
                              "illum 3\n");
    EXPECT_EQ(mixed.material.kind, MaterialKind::kSurface);
    expectNear(mixed.material.glossy, half);
    const auto more = static_cast<float>(0.5 * (0.953 + 0.02244) / (1 - meanOfCoat(0.52, 0.2)));
    expectNear(mixed.material.diffuse, {std::min(1.0f, more), 0.77f * more, 0.34f * more});
    expectNear(read(kBlender3, "Pr 0.2\nPm 0.5\nKd 1 0.77 0.34\nKs 0.5 0.5 0.5\nillum 2\n")
                   .material.glossy,
               half);
    const Result textured = read(kBlender3, "Ns 640\nmap_Kd gold.png\nKs 0.5 0.5 0.5\nillum 3\n");
    ASSERT_TRUE(textured.material.glossyTexture);
    EXPECT_EQ(textured.material.glossyTexture->file, "folder/gold.png");
    EXPECT_FALSE(textured.material.diffuseTexture);
    EXPECT_EQ(textured.material.glossy, (Colour{1, 1, 1}));
}

// Alpha cuts away: every material has an index of refraction, and it says nothing.
TEST(MtlDialect, BlendersAlphaIsNoGlass) {
    const Result r =
        read(kBlender3, "Ns 250\nKd 1 1 1\nKs 0.5 0.5 0.5\nNi 1.45\nd 0.25\nillum 9\n");
    EXPECT_EQ(r.material.kind, MaterialKind::kSurface);
    EXPECT_FLOAT_EQ(r.material.transparency, 0.75f);
    const Result glass =
        read(MtlDialect::kBlender4,
             "Kd 0.81 1 1\nKs 0.5 0.5 0.5\nNi 1.4\nd 1\nillum 2\nPr 0\nTf 1 1 1\n");
    EXPECT_EQ(glass.material.kind, MaterialKind::kDielectric);
    EXPECT_EQ(glass.material.ior, 1.4f);
    expectNear(glass.material.transmission, {0.9f, 1, 1});
    expectNear(read(kBlender3, "Kd 0.81 1 1\nNi 1.4\nPr 0\nTf 1 1 1\n").material.transmission,
               {0.81f, 1, 1});
    const Result frosted = read(kBlender3, "Kd 1 1 1\nNi 1.4\nPr 0.5\nTf 1 1 1\n");
    EXPECT_EQ(frosted.material.roughness, 0.5f);
    EXPECT_TRUE(frosted.heard.list.empty());
    // Blender writes no such illum: a person did.
    EXPECT_EQ(read(kBlender3, "Ns 250\nNi 1.33\nillum 7\n").material.kind,
              MaterialKind::kDielectric);
}

// On metal and glass a picture of roughness is what it is.
TEST(MtlDialect, PicturesOfRoughnessOnMetalAndGlass) {
    const Result metal = read(MtlDialect::kBlender4, "Kd 1 1 1\nPm 1\nmap_Pr rough.png\nillum 3\n");
    EXPECT_EQ(metal.material.kind, MaterialKind::kMirror);
    EXPECT_EQ(metal.material.roughness, 1.0f);
    ASSERT_TRUE(metal.material.roughnessTexture);
    EXPECT_EQ(metal.material.roughnessTexture->file, "folder/rough.png");
    EXPECT_TRUE(metal.material.roughnessTexture->isData);
    const Result glass =
        read(MtlDialect::kBlender4, "Kd 1 1 1\nTf 1 1 1\nNi 1.5\nmap_Pr rough.png\n");
    EXPECT_EQ(glass.material.kind, MaterialKind::kDielectric);
    EXPECT_TRUE(glass.material.roughnessTexture);
}

// Blender's exporters write the picture of a normal map as a bump map.
TEST(MtlDialect, BlendersBumpIsANormalMap) {
    const Result r = read(kBlender3, "Ns 250\nKd 1 1 1\nillum 2\nmap_Bump -bm 0.8 n.png\n");
    ASSERT_TRUE(r.material.normalTexture);
    EXPECT_EQ(r.material.normalTexture->strength, 0.8f);
    EXPECT_TRUE(r.heard.list.empty());
}

// Coat, sheen and the rest as each of its versions means them.
TEST(MtlDialect, BlendersLayers) {
    const std::string layers =
        "Kd 0.4 0.2 0.1\nPr 0.4\nPm 0\nPs 0.6\nPc 0.8\nPcr 0.1\n"
        "aniso 0.5\nanisor 0.25\nKs 0.5 0.5 0.5\nillum 2\n";
    const Result four = read(MtlDialect::kBlender4, layers);
    EXPECT_EQ(four.material.coat, 0.8f);
    EXPECT_EQ(four.material.coatRoughness, 0.1f);
    expectNear(four.material.sheen, {0.6f, 0.6f, 0.6f});
    EXPECT_EQ(four.material.sheenRoughness, 0.5f);
    EXPECT_EQ(four.material.anisotropy, 0.5f);
    EXPECT_EQ(four.material.anisotropyRotation, 0.25f);
    EXPECT_TRUE(four.heard.list.empty());
    // A quarter of a coat at most, and sheen that is half the colour's.
    const Result three = read(kBlender3, layers);
    EXPECT_FLOAT_EQ(three.material.coat, 0.2f);
    const float luminance = 0.2126f * 0.4f + 0.7152f * 0.2f + 0.0722f * 0.1f;
    expectNear(three.material.sheen,
               {0.6f, 0.3f + 0.3f * 0.2f / luminance, 0.3f + 0.3f * 0.1f / luminance});
}

// A picture of roughness is one on any surface.
TEST(MtlDialect, PicturesOfRoughnessOnSurfaces) {
    const Result r = read(MtlDialect::kBlender4, "Kd 0.5 0.5 0.5\nmap_Pr rough.png\nillum 2\n");
    EXPECT_EQ(r.material.kind, MaterialKind::kSurface);
    EXPECT_EQ(r.material.roughness, 1.0f);
    ASSERT_TRUE(r.material.roughnessTexture);
    EXPECT_TRUE(r.heard.list.empty());
}

// Files of no known program: with Pm they are translated, with an illum of their own they say
// themselves what is rough.
TEST(MtlDialect, KeysForPhysicallyBasedMaterialsInAnyFile) {
    const auto generic = [](const std::string& text) {
        return read(MtlDialect::kGeneric, text).material;
    };
    const MaterialData gold = generic("Kd 1 0.77 0.34\nPm 1\nPr 0.3\n");
    EXPECT_EQ(gold.kind, MaterialKind::kMirror);
    EXPECT_EQ(gold.roughness, 0.3f);
    expectNear(gold.glossy, {1, 0.77f, 0.34f});
    const MaterialData plastic = generic("Kd 0.5 0.1 0.1\nPr 0.3\nPm 0\n");
    EXPECT_EQ(plastic.kind, MaterialKind::kSurface);
    expectNear(plastic.glossy, {0.04f, 0.04f, 0.04f});
    const MaterialData mirror = generic("Ks 0.9 0.9 0.9\nillum 3\nPr 0.25\n");
    EXPECT_EQ(mirror.kind, MaterialKind::kMirror);
    EXPECT_FALSE(mirror.fresnel);
    EXPECT_EQ(mirror.roughness, 0.25f);
    expectNear(mirror.glossy, {0.9f, 0.9f, 0.9f});
    const MaterialData glass = generic("illum 7\nNi 1.33\nPr 0.25\n");
    EXPECT_EQ(glass.kind, MaterialKind::kDielectric);
    EXPECT_EQ(glass.roughness, 0.25f);
}

// The same surface once as what is no metal and once as metal, by the picture.
TEST(MtlDialect, PicturesOfMetalMixBoth) {
    const Result r =
        read(kBlender3,
             "Kd 1 1 1\nKs 0.5 0.5 0.5\nillum 2\nmap_Ns rough.png\nrefl metal.png\n"
             "map_d holes.png\nmap_Ke light.png\nnorm normals.png\nmap_Kd colour.png\n");
    const MaterialData& m = r.material;
    EXPECT_TRUE(r.heard.list.empty());
    ASSERT_EQ(m.parts.size(), 2u);
    ASSERT_TRUE(m.weightTexture);
    EXPECT_EQ(m.weightTexture->file, "folder/metal.png");
    EXPECT_TRUE(m.weightTexture->isData);
    EXPECT_EQ(m.weight, 1.0f);
    const MaterialData &surface = m.parts[0], &metal = m.parts[1];
    EXPECT_EQ(surface.name, "m (no metal)");
    EXPECT_EQ(surface.kind, MaterialKind::kSurface);
    EXPECT_EQ(surface.diffuseTexture->file, "folder/colour.png");
    EXPECT_NEAR(surface.glossy[0], 0.04f, 1e-6f);
    EXPECT_EQ(metal.kind, MaterialKind::kMirror);
    EXPECT_EQ(metal.glossyTexture->file, "folder/colour.png");
    for (const MaterialData* part : {&surface, &metal}) {
        EXPECT_EQ(part->roughnessTexture->file, "folder/rough.png");
        EXPECT_EQ(part->roughness, 1.0f);
        // What is the surface's whatever it is made of.
        EXPECT_FALSE(part->opacityTexture || part->normalTexture || part->emissionTexture);
        EXPECT_FALSE(part->emits());
    }
    EXPECT_TRUE(m.opacityTexture && m.normalTexture && m.emissionTexture && m.emits());
}

// The key of the exporter since Blender 3.2.
TEST(MtlDialect, APictureOfMetalHasThreeNames) {
    for (const char* key : {"refl", "map_refl", "map_Pm"})
        EXPECT_EQ(read(kBlender3, "Kd 1 1 1\nillum 2\n" + std::string(key) + " metal.png\n")
                      .material.parts.size(),
                  2u)
            << key;
}

TEST(MtlDialect, PicturesOfMetalAndRoughnessMayBeChannelsOfOne) {
    const Result r = read(MtlDialect::kGeneric,
                          "Kd 0.5 0.4 0.3\nPm 0.5\nmap_Pm -imfchan b orm.png\n"
                          "map_Pr -imfchan g orm.png\n");
    ASSERT_EQ(r.material.parts.size(), 2u);
    EXPECT_EQ(r.material.weightTexture->channel, 'b');
    EXPECT_EQ(r.material.weight, 0.5f);
    EXPECT_EQ(r.material.parts[0].roughnessTexture->channel, 'g');
    EXPECT_EQ(r.material.parts[1].roughnessTexture->channel, 'g');
    // Glass and mirrors by illum are none of it.
    EXPECT_TRUE(read(MtlDialect::kGeneric, "illum 7\nmap_Pm metal.png\n").material.parts.empty());
}

TEST(MtlDialect, OlderBlendersHaveAnotherLargestExponent) {
    EXPECT_NEAR(read(MtlDialect::kBlender28, "Ns 225\nKd 1 1 1\nKs 0.5 0.5 0.5\nillum 2\n")
                    .material.roughness,
                0.5, 1e-6);
}

// d and Tr both stand there, Ni 1.5 on everything; Ks is a highlight that takes nothing from Kd.
TEST(MtlDialect, ThreeDsMax) {
    const Result pane = read(MtlDialect::k3dsMax,
                             "Ns 10\nNi 1.5\nd 0.4\nTr 0.6\nTf 1 1 1\nillum 2\nKd 0.6 0.6 0.6\n"
                             "Ks 0.9 0.9 0.9\n");
    EXPECT_EQ(pane.material.kind, MaterialKind::kSurface);
    EXPECT_FLOAT_EQ(pane.material.transparency, 0.6f);
    expectNear(pane.material.diffuse, {0.6f, 0.6f, 0.6f});
    expectNear(pane.material.glossy, {0.4f, 0.4f, 0.4f});
    EXPECT_TRUE(pane.heard.list.empty());
    EXPECT_FLOAT_EQ(read(MtlDialect::k3dsMax, "Tr 1\nKd 1 1 1\n").material.transparency, 1.0f);
    EXPECT_EQ(read(MtlDialect::k3dsMax, "Ni 1.33\nd 0.1\nillum 2\n").material.kind,
              MaterialKind::kDielectric);
    EXPECT_EQ(read(MtlDialect::k3dsMax, "Ni 1.5\nd 0.1\nillum 7\n").material.kind,
              MaterialKind::kDielectric);
}

// illum 4 on everything; Tf is 1 less the transparency.
TEST(MtlDialect, Maya) {
    const Result opaque = read(MtlDialect::kMaya,
                               "illum 4\nKd 0.5 0.4 0.3\nKa 0 0 0\nTf 1 1 1\n"
                               "Ni 1\nKs 0.5 0.5 0.5\nNs 18\n");
    EXPECT_EQ(opaque.material.kind, MaterialKind::kSurface);
    EXPECT_EQ(opaque.material.transparency, 0.0f);
    expectNear(opaque.material.diffuse, {0.5f, 0.4f, 0.3f});
    expectNear(opaque.material.glossy, {0.5f, 0.5f, 0.5f});
    EXPECT_EQ(opaque.material.glossyExponent, 18.0f);
    EXPECT_TRUE(opaque.heard.list.empty());
    EXPECT_FLOAT_EQ(
        read(MtlDialect::kMaya, "illum 4\nKd 1 1 1\nTf 0.2 0.2 0.2\nNi 1\n").material.transparency,
        0.8f);
    const Result glass = read(MtlDialect::kMaya, "illum 4\nKd 0 0 0\nTf 0.1 0.2 0.3\nNi 1.6\n");
    EXPECT_EQ(glass.material.kind, MaterialKind::kDielectric);
    expectNear(glass.material.transmission, {0.9f, 0.8f, 0.7f});
}

TEST(MtlDialect, Rhino) {
    const Result matte = read(MtlDialect::kRhino,
                              "Ka 0 0 0\nKd 0.9 0.9 0.9\nKs 1 1 1\nTf 0 0 0\n"
                              "d 1\nNs 0\n");
    expectNear(matte.material.diffuse, {0.9f, 0.9f, 0.9f});
    EXPECT_EQ(matte.material.glossy, Colour{});
    const Result shiny =
        read(MtlDialect::kRhino, "Kd 0.9 0.9 0.9\nKs 1 1 1\nTf 0 0 0\nd 1\nNs 80\n");
    expectNear(shiny.material.diffuse, {0.9f, 0.9f, 0.9f});
    expectNear(shiny.material.glossy, {0.1f, 0.1f, 0.1f});
    const Result glass = read(MtlDialect::kRhino, "Kd 1 1 1\nTf 0 0 0\nd 0.3\nNi 1.5\nNs 80\n");
    EXPECT_EQ(glass.material.transmission, (Colour{1, 1, 1}));
}

TEST(MtlDialect, SketchUpAndZBrush) {
    const Result sketch =
        read(MtlDialect::kSketchUp, "Ka 0 0 0\nKd 0.9 0.9 0.9\nKs 0.33 0.33 0.33\nd 0.5\nNs 20\n");
    EXPECT_EQ(sketch.material.glossy, Colour{});
    expectNear(sketch.material.diffuse, {0.9f, 0.9f, 0.9f});
    EXPECT_FLOAT_EQ(sketch.material.transparency, 0.5f);
    const Result brush = read(MtlDialect::kZBrush, "Kd 0.8 0.8 0.8\nKs 1 1 1\nNs 20\nillum 2\n");
    expectNear(brush.material.diffuse, {0.8f, 0.8f, 0.8f});
    expectNear(brush.material.glossy, {0.2f, 0.2f, 0.2f});
}

class MtlDialectFiles : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string name = ::testing::TempDir() + "pm_dialects.XXXXXX";
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        m_folder = name;
    }
    void TearDown() override {
        std::error_code ignored;
        fs::remove_all(m_folder, ignored);
    }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(m_folder / name, std::ios::binary) << text;
    }
    MaterialFile library(const std::string& sceneHeader, const std::string& libraryHeader,
                         const ReadRules& rules = {}) const {
        write("s.obj",
              sceneHeader + "mtllib s.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        write("s.mtl", libraryHeader + "newmtl m\nKd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nNs 250\n");
        Heard heard;
        return readObjFile(m_folder / "s.obj", heard.sink, {}, {}, rules).materialFiles.at(0);
    }
    fs::path m_folder;
};

// The library's own header first, then the scene's; the option over both.
TEST_F(MtlDialectFiles, AreChosenAndTheReasonIsTold) {
    const std::string blender3 = "# Blender 3.4.1\n", max = "# 3ds Max Wavefront OBJ Exporter\n";
    const std::string old = "# Blender MTL File: 'None'\n";
    EXPECT_EQ(library(blender3, max).dialect, "3dsmax");
    EXPECT_EQ(library(blender3, "# mine\n").dialect, "blender3");
    EXPECT_EQ(library(blender3, "").reason,
              "the header of " + (m_folder / "s.obj").string() + " says Blender 3.4");
    EXPECT_EQ(library("", "").dialect, "generic");
    EXPECT_EQ(library("", "").reason, "no header says which program wrote it");
    // Old exporters wrote their version into the OBJ file only.
    EXPECT_EQ(library("# Blender v2.73 (sub 0) OBJ File: 'x'\n", old).dialect, "blender2.7");
    EXPECT_EQ(library("", old).dialect, "blender2.8");
    const MaterialFile asked = library(blender3, max, {"maya", {}, {}});
    EXPECT_EQ(asked.dialect, "maya");
    EXPECT_EQ(asked.reason, "--mtl-dialect asks for it");
}

}  // namespace
}  // namespace pm::host::test
