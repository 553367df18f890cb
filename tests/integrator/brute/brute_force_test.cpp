// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Both integrators against brute force, in scenes of every kind that a path goes through.
#include "tests/integrator/brute/brute_force.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <memory>

#include "tests/integrator/brute/brute_rooms.h"
#include "tests/support/mixture.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

constexpr std::int32_t kWidth = 12, kHeight = 8;

// Texture 0: a normal that leans to and fro along u. Texture 1: holes.
class Pictures final : public TextureSource {
  public:
    Texel lookUp(std::int32_t index, const TextureContext& at) const override {
        const Vec2f uv = at.uv;
        const auto square = [](float x) { return static_cast<int>(std::floor(4.0f * x)); };
        if (index == 0) return {square(uv.x) % 2 == 0 ? 0.58f : 0.42f, 128.0f / 255, 0.97f, 1.0f};
        const float value = (square(uv.x) + square(uv.y)) % 2 == 0 ? 0.0f : 1.0f;
        return {value, value, value, 1.0f};
    }
    std::array<std::uint32_t, 2> texels(std::int32_t) const override { return {4, 4}; }
    std::uint64_t failureCount() const override { return 0; }
};

TriangleMesh square(Vec3f p, Vec3f e0, Vec3f e1) {
    TriangleMesh mesh;
    mesh.positions = {p, p + e0, p + e0 + e1, p + e1};
    mesh.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles = mesh.texcoordIndices = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

MaterialDescription absorbing(MaterialDescription m, Rgb left, float distance) {
    m.attenuationColour = left;
    m.attenuationDistance = distance;
    return m;
}

Room nestedBodies() {
    SceneMaker maker = litRoom();
    maker.box({-0.8, -0.9, -0.6}, {0.8, 0.2, 0.6},
              maker.material(absorbing(glass(1.33f), {0.5f, 0.8f, 0.9f}, 0.5f)), false);
    maker.sphere({-0.3, -0.4, 0}, 0.3,
                 maker.material(absorbing(glass(1.6f), {0.9f, 0.3f, 0.3f}, 0.4f)));
    maker.sphere({0.4, -0.5, 0}, 0.25, maker.diffuse({0.7f, 0.7f, 0.2f}));
    return {"nested bodies", maker};
}

// All of it in a body, and a smaller one of the same index.
Room lampInABody() {
    SceneMaker maker = litRoom();
    maker.box({-2, -2, -2}, {2, 2, 6},
              maker.material(absorbing(glass(1.33f), {0.7f, 0.8f, 0.9f}, 1.0f)), false);
    maker.box({-0.7, -0.95, -0.7}, {0.1, 0, 0.5},
              maker.material(absorbing(glass(1.33f), {0.2f, 0.8f, 0.4f}, 0.5f)), false);
    return {"lamp in a body", maker};
}

Room smoke() {
    SceneMaker maker = litRoom();
    maker.box({-0.8, -0.95, -0.7}, {0.8, 0.3, 0.7},
              maker.material(absorbing(glass(1.0f), {0.3f, 0.5f, 0.8f}, 0.8f)), false);
    maker.sphere({0.3, -0.5, 0}, 0.3, maker.material(mirror()));
    return {"body of index one", maker};
}

Room alpha() {
    MaterialDescription half = glass();
    half.transparency = 0.5f;
    MaterialDescription sheet;
    sheet.diffuse = {0.2f, 0.6f, 0.3f};
    sheet.opacityTexture = 1;
    SceneMaker maker = withBalls(glass(), mirror());
    maker.box({-0.5, -0.5, 0.45}, {0.5, 0.1, 0.7}, maker.material(half), false);
    maker.mesh(square({-0.9f, 0.4f, -0.7f}, {1.8f, 0, 0}, {0, 0, 1.4f}), maker.material(sheet));
    maker.description.textures = std::make_shared<Pictures>();
    return {"alpha", maker};
}

Room normalMap() {
    MaterialDescription floor = rough(mirror(), 0.3f);
    floor.normalTexture = 0;
    SceneMaker maker = withBalls(glass(), rough(mirror(), 0.2f));
    maker.mesh(square({-0.98f, -0.98f, 0.98f}, {1.96f, 0, 0}, {0, 0, -1.96f}),
               maker.material(floor));
    maker.description.textures = std::make_shared<Pictures>();
    return {"normal map", maker};
}

Room coats() {
    MaterialDescription coat;
    coat.diffuse = {0.3f, 0.2f, 0.5f};
    coat.coat = 1.0f;
    coat.coatRoughness = 0.2f;
    MaterialDescription cloth;
    cloth.diffuse = {0.4f, 0.3f, 0.2f};
    cloth.sheen = Rgb(0.8f);
    return {"coat and sheen", withBalls(coat, cloth)};
}

Room cutLamp() {
    SceneMaker maker = openRoom();
    MaterialDescription lamp;
    lamp.emission = Rgb(4.0f);
    lamp.opacityTexture = 1;
    maker.mesh(square({-0.95f, 0.98f, -0.95f}, {1.9f, 0, 0}, {0, 0, 1.9f}), maker.material(lamp));
    maker.sphere({0.4, -0.5, 0.1}, 0.4, maker.material(rough(mirror(), 0.3f)));
    maker.description.textures = std::make_shared<Pictures>();
    return {"lamp with holes", maker};
}

Room hidden() {
    SceneMaker maker = withBalls(glass(), rough(mirror(), 0.4f));
    maker.quad({-0.9, 0.3, -0.9}, {1.8, 0, 0}, {0, 0, 1.8}, maker.diffuse(Rgb(0.4f)));
    maker.description.instances.back().hiddenFrom = kShadowRays | kCameraRays;
    return {"hidden from shadows", maker};
}

// A ball that is metal in squares, and one of five lobes.
Room mixtures() {
    SceneMaker maker = withBalls(rough(mirror(), 0.3f), MaterialDescription{});
    const auto plain = maker.diffuse({0.6f, 0.4f, 0.3f}),
               wide = maker.material(rough(mirror(), 0.3f)),
               narrow = maker.material(rough(mirror(), 0.12f)), window = maker.material(glass());
    MaterialDescription cloth;
    cloth.sheen = Rgb(0.8f);
    cloth.diffuse = {0.2f, 0.3f, 0.5f};
    MaterialDescription squares = mixture(plain, wide, 1);
    squares.weightTexture = 1;
    const auto count = maker.description.instances.size();
    maker.description.instances[count - 2].materials = {maker.material(squares)};
    const auto soft = maker.material(mixture(plain, maker.material(cloth), 0.5f)),
               shiny = maker.material(mixture(wide, narrow, 0.5f)),
               five = maker.material(
                   mixture(maker.material(mixture(soft, shiny, 0.5f)), window, 0.4f));
    maker.description.instances[count - 1].materials = {five};
    maker.description.textures = std::make_shared<Pictures>();
    return {"mixtures of mixtures", maker};
}

std::vector<Room> scenes() {
    return {{"smooth glass and mirror", withBalls(glass(), mirror())},
            {"rough glass", withBalls(rough(glass(), 0.2f), rough(glass(), 0.5f))},
            nestedBodies(),
            lampInABody(),
            smoke(),
            alpha(),
            normalMap(),
            coats(),
            cutLamp(),
            hidden(),
            {"instances", mirrorsOfOneMesh()},
            {"sky", ballsUnderASky()},
            mixtures()};
}

const std::vector<Rect> kRegions = {
    {0, 0, 6, 4}, {6, 0, 12, 4}, {0, 4, 6, 8}, {6, 4, 12, 8}, {0, 0, 12, 8}};

// By independent parts of the samples.
std::vector<Measured> byBruteForce(const Scene& scene, std::uint32_t samples) {
    constexpr std::size_t kParts = 16;
    const BruteForce brute(scene, kWidth, kHeight);
    std::vector<std::array<std::array<double, 3>, kParts>> parts(kRegions.size());
    tbb::parallel_for(std::size_t{0}, kParts * kRegions.size(), [&](std::size_t i) {
        const std::size_t region = i / kParts, part = i % kParts;
        parts[region][part] =
            brute.mean(kRegions[region], samples / kParts, 1000 * region + part + 1);
    });
    std::vector<Measured> found(kRegions.size());
    for (std::size_t region = 0; region < kRegions.size(); ++region)
        for (std::size_t c = 0; c < 3; ++c) {
            double sum = 0, squares = 0;
            for (const auto& part : parts[region]) {
                sum += part[c];
                squares += part[c] * part[c];
            }
            const double mean = sum / kParts;
            found[region].mean[c] = mean;
            found[region].standardError[c] =
                std::sqrt((squares / kParts - mean * mean) / (kParts - 1));
        }
    return found;
}

class BruteForceScenes : public ::testing::TestWithParam<Room> {};

// A number in 16 000 is beyond 4 standard errors; there are 390. bias: of photons' estimates.
TEST_P(BruteForceScenes, BothIntegratorsAgree) {
    const bool isLong = std::getenv("PM_LONG_LOOKS") != nullptr;
    const std::uint32_t samples = isLong ? 600'000 : 64'000;
    const auto scene = GetParam().maker.build();
    const std::vector<Measured> right = byBruteForce(*scene, samples);
    for (const IntegratorKind integrator : {IntegratorKind::kPath, IntegratorKind::kPhoton}) {
        const bool isPhoton = integrator == IntegratorKind::kPhoton;
        RenderSettings settings =
            smallFrame(kWidth, kHeight, integrator, isPhoton ? 4 : 160, isLong ? 3 : 2);
        settings.photons = 20'000;
        const auto found = measureRegions(scene, settings, {0, 0, kWidth, kHeight}, kRegions);
        for (std::size_t r = 0; r < kRegions.size(); ++r)
            EXPECT_TRUE(agree(found[r].beauty, right[r], isPhoton ? 0.02 : 0.002))
                << fmt::format("{}, region {}", isPhoton ? "photon" : "path", r);
    }
}

INSTANTIATE_TEST_SUITE_P(Of, BruteForceScenes, ::testing::ValuesIn(scenes()), roomName);

// A twin that is 6 % off in one thing is told.
TEST(BruteForce, TellsATwin) {
    SceneMaker maker = litRoom();
    const auto right = byBruteForce(*maker.build(), 64'000);
    for (MaterialDescription& m : maker.description.materials)
        if (!isBlack(m.emission)) m.emission = m.emission * 1.06f;
    const auto twin =
        measure(maker.build(), smallFrame(kWidth, kHeight, IntegratorKind::kPath, 160, 2));
    fmt::print("    {} +- {}, twin {} +- {}\n", right.back().mean[1], right.back().standardError[1],
               twin.beauty.mean[1], twin.beauty.standardError[1]);
    EXPECT_FALSE(agree(twin.beauty, right.back(), 0.002));
}

}  // namespace
}  // namespace pm::test
