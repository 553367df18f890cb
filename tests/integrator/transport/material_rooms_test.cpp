// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Photon maps against path tracing in twelve rooms of rough metal and glass, coats, plaster,
// leaves, absorbing glass, maps and mixtures, under lights of every kind, by 8 x 8 regions.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/looks.h"
#include "tests/support/rooms.h"

namespace pm::test {
namespace {

// Texture 0: chequers of two values. Texture 1: a normal that leans to and fro along u.
class Chequers final : public TextureSource {
  public:
    Chequers(float dark, float bright) : m_dark(dark), m_bright(bright) {}
    Texel lookUp(std::int32_t index, const TextureContext& at) const override {
        const Vec2f uv = at.uv;
        const auto square = [](float x) { return static_cast<int>(std::floor(4.0f * x)); };
        if (index == 1) return {square(uv.x) % 2 == 0 ? 0.58f : 0.42f, 128.0f / 255, 0.97f, 1.0f};
        const float value = (square(uv.x) + square(uv.y)) % 2 == 0 ? m_dark : m_bright;
        return {value, value, value, 1.0f};
    }
    std::array<std::uint32_t, 2> texels(std::int32_t) const override { return {4, 4}; }
    std::uint64_t failureCount() const override { return 0; }

  private:
    float m_dark, m_bright;
};

MaterialDescription metal(float roughness, Rgb colour = Rgb(0.9f, 0.8f, 0.6f)) {
    MaterialDescription m = mirror();
    m.glossy = colour;
    m.roughness = roughness;
    return m;
}

MaterialDescription gold(float roughness) {
    MaterialDescription m = metal(roughness, Rgb(1.0f));
    m.conductorN = {0.14f, 0.37f, 1.44f};
    m.conductorK = {3.98f, 2.38f, 1.6f};
    return m;
}

MaterialDescription roughGlass(float roughness) {
    MaterialDescription m = glass();
    m.roughness = roughness;
    return m;
}

MaterialDescription surface(Rgb diffuse, Rgb glossy = {}, float roughness = 0) {
    MaterialDescription m;
    m.diffuse = diffuse;
    m.glossy = glossy;
    m.roughness = roughness;
    return m;
}

// A floor with texture coordinates, a little above the room's.
void plate(SceneMaker& maker, const MaterialDescription& material) {
    TriangleMesh mesh;
    mesh.positions = {{-0.95f, -0.97f, 0.95f},
                      {0.95f, -0.97f, 0.95f},
                      {0.95f, -0.97f, -0.95f},
                      {-0.95f, -0.97f, -0.95f}};
    mesh.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles = mesh.texcoordIndices = {{0, 1, 2}, {0, 2, 3}};
    maker.mesh(mesh, maker.material(material));
}

void balls(SceneMaker& maker, const MaterialDescription& left, const MaterialDescription& right) {
    maker.sphere({-0.45, -0.5, -0.2}, 0.35, maker.material(left));
    maker.sphere({0.45, -0.5, 0.1}, 0.35, maker.material(right));
}

SceneMaker litRoom() {
    SceneMaker maker = openRoom();
    ceilingLamp(maker, 0.5, Rgb(8.0f));
    return maker;
}

// A floor and balls over it under an open sky, seen from above.
SceneMaker outside(const MaterialDescription& floor) {
    SceneMaker maker;
    plate(maker, floor);
    maker.quad({-1, -1, -1}, {2, 0, 0}, {0, 1.2, 0}, maker.diffuse({0.5f, 0.6f, 0.7f}));
    maker.camera({0, 0.9, 3.2}, {0, -0.6, 0}, {0, 1, 0}, 34);
    return maker;
}

// The same below a lamp, with little else to see: what the floor receives tells.
SceneMaker stage(const MaterialDescription& floor) {
    SceneMaker maker;
    plate(maker, floor);
    maker.quad({-1, -1, -1}, {2, 0, 0}, {0, 1.2, 0}, maker.diffuse(Rgb(0.1f)));
    ceilingLamp(maker, 0.4, Rgb(8.0f));
    maker.camera({0, 0.8, 3.2}, {0, -0.6, 0}, {0, 1, 0}, 34);
    return maker;
}

Room underMetals() {
    SceneMaker maker = litRoom();
    balls(maker, metal(0.15f), metal(0.35f));
    maker.sphere({0, 0.2, -0.5}, 0.3, maker.material(metal(0.7f)));
    return {"metals", maker};
}

Room overGold(float roughness = 0.3f) {
    SceneMaker maker = stage(gold(roughness));
    balls(maker, glass(), gold(0.1f));
    return {"gold by n and k", maker};
}

Room roughGlasses() {
    SceneMaker maker = litRoom();
    balls(maker, roughGlass(0.15f), roughGlass(0.35f));
    return {"rough glass", maker};
}

Room coats() {
    SceneMaker maker = stage(surface({0.3f, 0.2f, 0.2f}, Rgb(0.2f), 0.3f));
    balls(maker, glass(), surface({0.2f, 0.3f, 0.5f}, Rgb(0.08f), 0.1f));
    return {"coats", maker};
}

Room plaster() {
    SceneMaker maker = litRoom();
    MaterialDescription rough = surface({0.7f, 0.6f, 0.5f});
    rough.diffuseRoughness = 0.8f;
    plate(maker, rough);
    balls(maker, mirror(), rough);
    return {"plaster", maker};
}

Room leaves() {
    SceneMaker maker = litRoom();
    MaterialDescription leaf = surface({0.2f, 0.4f, 0.1f});
    leaf.diffuseTransmission = {0.1f, 0.5f, 0.1f};
    maker.quad({-0.9, -0.3, 0.5}, {1.0, 0.1, 0}, {0, 0.2, -1.0}, maker.material(leaf));
    maker.sphere({-0.4, 0.3, 0}, 0.3, maker.material(glass()));
    return {"leaves", maker};
}

Room absorbing() {
    MaterialDescription red = glass();
    red.attenuationColour = {0.8f, 0.2f, 0.1f};
    red.attenuationDistance = 0.4f;
    MaterialDescription floor = metal(0.8f);
    floor.roughnessTexture = 0;
    SceneMaker maker = stage(floor);
    balls(maker, red, metal(0.5f));
    maker.description.textures = std::make_shared<Chequers>(0.5f, 1.0f);
    return {"absorbing glass over textured metal", maker};
}

Room mapped() {
    MaterialDescription floor = metal(0.35f);
    floor.normalTexture = 1;
    SceneMaker maker = stage(floor);
    balls(maker, glass(), surface(Rgb(0.5f)));
    maker.description.textures = std::make_shared<Chequers>(0.5f, 1.0f);
    return {"normal map", maker};
}

Room mixtures() {
    MaterialDescription floor = surface({0.3f, 0.4f, 0.2f}, Rgb(0.4f));
    floor.glossyExponent = 200;
    SceneMaker maker = stage(floor);
    MaterialDescription broad = surface({0.4f, 0.2f, 0.2f}, Rgb(0.4f));
    broad.glossyExponent = 20;
    balls(maker, roughGlass(0.15f), broad);
    return {"mixtures", maker};
}

Room underSky() {
    SceneMaker maker = outside(metal(0.5f));
    balls(maker, glass(), metal(0.3f));
    maker.sky({0.5f, 0.7f, 1.0f});
    return {"sky", maker};
}

Room underSun() {
    SceneMaker maker = outside(metal(0.4f));
    balls(maker, mirror(), roughGlass(0.3f));
    maker.sun({-0.4, -1, -0.3}, Rgb(2.0f), 0.2);
    return {"sun", maker};
}

// Little noise and much glass.
Room glassUnderSky(float tint) {
    SceneMaker maker = outside(surface(Rgb(0.3f)));
    MaterialDescription left = roughGlass(0.15f), right = roughGlass(0.35f);
    left.transmission = right.transmission = Rgb(tint);
    balls(maker, left, right);
    maker.sky({0.5f, 0.7f, 1.0f});
    return {"rough glass under a sky", maker};
}

// What path tracing finds of a point's light: by way of no delta lobe.
Room underPoint() {
    SceneMaker maker = openRoom();
    plate(maker, metal(0.5f));
    balls(maker, metal(0.35f), metal(0.6f));
    maker.pointLight({0.1, 0.7, 0.3}, Rgb(2.0f));
    return {"point", maker};
}

std::vector<Room> rooms() {
    return {underMetals(), overGold(), roughGlasses(), coats(),    plaster(),  leaves(),
            absorbing(),   mapped(),   mixtures(),     underSky(), underSun(), underPoint()};
}

constexpr LookSize kShort{
    .frame = 32, .region = 4, .renders = 5, .passes = 3, .photons = 15'000, .ofPictureOnly = true};

double largestZ(const Look& seen, Layer layer) {
    double largest = 0;
    for (std::size_t r = 0; r < seen.path.front().size(); ++r)
        for (std::size_t c = 0; c < 3; ++c) largest = std::max(largest, seen.z(r, layer, c));
    return largest;
}

// Twins of photons are told from what paths see: glass that lets 3 % less through, once a
// crossing, and a floor of gold a tenth rougher.
TEST(MaterialRooms, TwinsAreRefused) {
    LookSize more = kShort;
    more.renders = 12;
    const Look glass =
        lookAtTwin(glassUnderSky(0.97f).maker.build(), glassUnderSky(1).maker.build(), more);
    const Look gold = lookAtTwin(overGold(0.33f).maker.build(), overGold().maker.build(), kShort);
    fmt::print("    largest |z| of regions {:.2f} and {:.2f}, of frames {:.2f} and {:.2f}\n",
               largestZ(glass, kBeauty), largestZ(gold, kBeauty),
               largestZ(glass.ofWholeFrame(), kBeauty), largestZ(gold.ofWholeFrame(), kBeauty));
    EXPECT_GT(largestZ(glass, kBeauty), 4);
    EXPECT_GT(largestZ(gold, kBeauty), 4);
}

// Of 12 rooms, 64 regions and 3 channels, which tell much the same of a region: some 800 numbers a
// layer that are not each other's. One in 16 000 normal numbers is beyond 4, so that of the
// picture's none is to be expected; what is is looked at again. PM_LONG_LOOKS=1: more of all.
TEST(MaterialRooms, PhotonsAgreeWithPaths) {
    const bool isLong = std::getenv("PM_LONG_LOOKS") != nullptr;
    const char* const only = std::getenv("PM_ROOM");
    LookSize size = kShort;
    if (isLong) size = {.frame = 48, .region = 6, .renders = 16, .passes = 8};
    Look frames;
    for (const Room& room : rooms()) {
        if (only != nullptr && room.name != only) continue;
        const auto scene = room.maker.build();
        const Look first = look(scene, size);
        const Look frame = first.ofWholeFrame();
        expectFrameAgrees(frame, room.name + ", frame");
        lookAgain(scene, size, first, room.name);
        addFrame(frames, frame);
    }
    expectFrameAgrees(frames, "all frames");
}

}  // namespace
}  // namespace pm::test
