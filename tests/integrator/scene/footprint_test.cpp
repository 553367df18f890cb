// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What rays cover of textures: against where the rays beside them come out, and what a frame reads.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "integrator/scene/camera.h"
#include "integrator/transport/path/camera_step.h"
#include "integrator/transport/path/path_integrator.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

// A checker of 16 x 16 squares over the unit square, as a pyramid of means of which a look-up takes
// one texel, by the footprint's longer side; and which tiles of 64 x 64 texels were asked for.
class Checker : public TextureSource {
  public:
    static constexpr int kSize = 1024, kTile = 64, kLevels = 11, kTexelsOfSquare = kSize / 16;

    // False: look-ups take the finest level, as if nothing were known of footprints.
    explicit Checker(int textures = 1, bool filters = true)
        : m_textures(textures),
          m_filters(filters),
          m_read(static_cast<std::size_t>(textures) * kLevels * kTilesOfLevel) {}

    Texel lookUp(std::int32_t index, const TextureContext& at) const override {
        const Vec2f uv = at.uv;
        const UvFootprint& footprint = at.footprint;
        const float longest = std::max(std::hypot(footprint.x.x, footprint.x.y),
                                       std::hypot(footprint.y.x, footprint.y.y));
        const int level =
            m_filters ? static_cast<int>(std::clamp(std::log2(std::max(longest * kSize, 1.0f)),
                                                    0.0f, kLevels - 1.0f))
                      : 0;
        const int size = kSize >> level;
        const auto texel = [&](float v) {
            return std::min(size - 1,
                            static_cast<int>((v - std::floor(v)) * static_cast<float>(size)));
        };
        const int x = texel(uv.x), y = texel(uv.y);
        const auto tile = static_cast<std::size_t>((index * kLevels + level) * kTilesOfLevel +
                                                   y / kTile * (kSize / kTile) + x / kTile);
        m_read[tile].store(true, std::memory_order_relaxed);
        if ((1 << level) > kTexelsOfSquare) return {0.5f, 0.5f, 0.5f, 1.0f};
        const int square = kTexelsOfSquare >> level;
        const float value =
            (x / square + y / square) % 2 == 0 ? 0.9f : 0.1f;  // black would end paths
        return {value, value, value, 1.0f};
    }
    std::array<std::uint32_t, 2> texels(std::int32_t) const override { return {kSize, kSize}; }
    std::uint64_t failureCount() const override { return 0; }

    // Of all tiles that were read, over those of the finest levels.
    double shareRead() const {
        double texels = 0;
        for (std::size_t i = 0; i < m_read.size(); ++i) {
            const int size = kSize >> (i / kTilesOfLevel % kLevels);
            const double side = std::min(size, kTile);
            texels += m_read[i].load() ? side * side : 0.0;
        }
        return texels / (static_cast<double>(m_textures) * kSize * kSize);
    }
    bool hasRead(int level) const {
        for (std::size_t i = 0; i < m_read.size(); ++i)
            if (m_read[i].load() && static_cast<int>(i / kTilesOfLevel % kLevels) == level)
                return true;
        return false;
    }

  private:
    static constexpr int kTilesOfLevel = (kSize / kTile) * (kSize / kTile);
    int m_textures;
    bool m_filters;
    mutable std::vector<std::atomic<bool>> m_read;
};

std::uint32_t textured(SceneMaker& maker, std::int32_t texture = 0) {
    MaterialDescription material;
    material.diffuse = Rgb(1.0f);
    material.diffuseTexture = texture;
    return maker.material(material);
}

// uv from 0 to `repeats` along both edges.
void texturedQuad(SceneMaker& maker, Vec3f p, Vec3f e0, Vec3f e1, float repeats,
                  std::uint32_t material) {
    TriangleMesh mesh;
    mesh.positions = {p, p + e0, p + e0 + e1, p + e1};
    mesh.texcoords = {{0, 0}, {repeats, 0}, {repeats, repeats}, {0, repeats}};
    mesh.triangles = mesh.texcoordIndices = {{0, 1, 2}, {0, 2, 3}};
    maker.mesh(mesh, material);
}

// Where a path through a place of the frame comes to what has a texture.
struct End {
    Vec2f uv;
    UvFootprint footprint;
    std::vector<Lobe> lobes;
    bool isThere = false;
};

constexpr std::int32_t kWidth = 40, kHeight = 30;

End endOf(const Scene& scene, const Camera& camera, double x, double y, std::uint32_t index) {
    End end;
    const Sampler sampler(1, 0, index, 0);
    const Ray first = camera.ray({x, y});
    followCameraPath(scene, first, camera.footprint({x, y}, first), sampler,
                     [&](const PathStop& stop) {
                         end.isThere = stop.bsdf.has(Lobe::kDiffuse);
                         end.uv = stop.surface.uv;
                         end.footprint = stop.surface.footprint;
                         if (!end.isThere) end.lobes.push_back(stop.next);
                         return !end.isThere;
                     });
    return end;
}

float sizeOf(Vec2f v) {
    return std::hypot(v.x, v.y);
}

// Compares footprints with how far neighbours come out. Returns how many paths went by `way`.
int expectDifferentials(const SceneMaker& maker, const std::vector<Lobe>& way, float tolerance) {
    const auto scene = maker.build();
    const Camera camera(*scene, kWidth, kHeight);
    constexpr double kStep = 0.05;
    int found = 0;
    for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
        const double x = i % kWidth + 0.5, y = i / kWidth + 0.5;
        const End end = endOf(*scene, camera, x, y, i);
        const End right = endOf(*scene, camera, x + kStep, y, i);
        const End below = endOf(*scene, camera, x, y + kStep, i);
        if (!end.isThere || end.lobes != way || right.lobes != way || below.lobes != way ||
            !right.isThere || !below.isThere)
            continue;
        ++found;
        const auto off = [&](const End& other, Vec2f side) {
            const auto step = static_cast<float>(kStep);
            return sizeOf(
                {(other.uv.x - end.uv.x) / step - side.x, (other.uv.y - end.uv.y) / step - side.y});
        };
        const float size = std::max(sizeOf(end.footprint.x), sizeOf(end.footprint.y));
        EXPECT_GT(size, 0.0f);
        EXPECT_LT(off(right, end.footprint.x), tolerance * size) << x << ", " << y;
        EXPECT_LT(off(below, end.footprint.y), tolerance * size) << x << ", " << y;
    }
    return found;
}

// A wall behind all else, seen at a slant.
SceneMaker wall() {
    SceneMaker maker;
    maker.description.textures = std::make_shared<Checker>();
    texturedQuad(maker, {-20, -20, -12}, {40, 0, 10}, {0, 40, 0}, 3, textured(maker));
    return maker;
}

TEST(Footprint, OfAPixelOnAWall) {
    SceneMaker maker = wall();
    maker.camera({0, 0, 3}, {1, 0.5, -4}, {0, 1, 0}, 40);
    EXPECT_GT(expectDifferentials(maker, {}, 0.01f), kWidth * kHeight / 2);
}

TEST(Footprint, GoesOnOffAFlatMirror) {
    SceneMaker maker = wall();
    maker.quad({-3, -3, 3}, {6, 0, 0}, {0, 6, 1}, maker.material(mirror()));
    maker.camera({0, 0, 1}, {0.3, 0.2, 3}, {0, 1, 0}, 40);
    EXPECT_GT(expectDifferentials(maker, {Lobe::kReflection}, 0.01f), kWidth * kHeight / 2);
}

TEST(Footprint, GoesOnThroughASlab) {
    SceneMaker maker = wall();
    maker.box({-5, -5, 0}, {5, 5, 1}, maker.material(glass()), false);
    maker.camera({0, 0, 3}, {2, 1, 0}, {0, 1, 0}, 40);
    EXPECT_GT(expectDifferentials(maker, {Lobe::kRefraction, Lobe::kRefraction}, 0.01f),
              kWidth * kHeight / 4);
}

// Light bends at one boundary only.
TEST(Footprint, GoesOnIntoGlass) {
    SceneMaker maker = wall();
    maker.quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}, maker.material(glass()));
    maker.camera({0, 0, 2}, {2, 1, 0}, {0, 1, 0}, 40);
    EXPECT_GT(expectDifferentials(maker, {Lobe::kRefraction}, 0.01f), kWidth * kHeight / 4);
}

TEST(Footprint, WidensOffCurvedMirrors) {
    for (const bool isMesh : {false, true}) {
        SceneMaker maker = wall();
        if (isMesh)
            maker.meshSphere({0, 0, 4}, 1, maker.material(mirror()), false, 64);
        else
            maker.sphere({0, 0, 4}, 1, maker.material(mirror()));
        maker.camera({0, 0, 0}, {0, 0, 4}, {0, 1, 0}, 12);
        EXPECT_GT(expectDifferentials(maker, {Lobe::kReflection}, isMesh ? 0.15f : 0.05f),
                  kWidth * kHeight / 2);
    }
}

TEST(Footprint, OfAPixelOnASphere) {
    SceneMaker maker;
    maker.description.textures = std::make_shared<Checker>();
    maker.sphere({0, 0, 0}, 1, textured(maker));
    maker.camera({0, 0.5, 4}, {0, 0, 0}, {0, 1, 0}, 18);
    EXPECT_GT(expectDifferentials(maker, {}, 0.1f), kWidth * kHeight / 2);
}

// A floor to the horizon, one sample a pixel.
struct Horizon {
    double greatestError = 0;  // of a pixel's colour, in rows whose pixels cover several squares
    double shareRead = 0;
    bool readsCoarse = false;
};

Horizon floorToTheHorizon(bool filters) {
    SceneMaker maker;
    const auto checker = std::make_shared<Checker>(1, filters);
    maker.description.textures = checker;
    texturedQuad(maker, {-4000, 0, 10}, {8000, 0, 0}, {0, 0, -8000}, 8000, textured(maker));
    maker.sky(Rgb(1.0f));
    maker.camera({0.3, 1, 0}, {0.3, 1, -1}, {0, 1, 0}, 60);
    const auto scene = maker.build();
    const LightSampler lights(*scene);
    constexpr std::int32_t kAcross = 160, kDown = 120, kFarRows = 15;
    const Camera camera(*scene, kAcross, kDown);
    Horizon found;
    for (std::int32_t row = kDown / 2; row < kDown; ++row)
        for (std::int32_t column = 0; column < kAcross; ++column) {
            const Sampler sampler(1, 0, static_cast<std::uint64_t>(row),
                                  static_cast<std::uint32_t>(column));
            const Vec2f at = sampler.get2D(Purpose::kPlace);
            const double x = column + static_cast<double>(at.x),
                         y = row + static_cast<double>(at.y);
            const Ray ray = camera.ray({x, y});
            const SampleRadiance seen =
                PathIntegrator(*scene, lights).sample(ray, sampler, camera.footprint({x, y}, ray));
            if (seen.coverage > 0.0f && row < kDown / 2 + kFarRows)
                found.greatestError = std::max(found.greatestError,
                                               std::abs(static_cast<double>(seen.albedo.g) - 0.5));
        }
    found.shareRead = checker->shareRead();
    found.readsCoarse = checker->hasRead(Checker::kLevels - 1);
    return found;
}

TEST(Footprint, FloorGoesToItsMeanAtTheHorizon) {
    const Horizon filtered = floorToTheHorizon(true), finest = floorToTheHorizon(false);
    EXPECT_LT(filtered.greatestError, 1e-6);
    EXPECT_TRUE(filtered.readsCoarse);
    EXPECT_LT(filtered.shareRead, 0.1);
    // What the test would find without footprints.
    EXPECT_NEAR(finest.greatestError, 0.4, 1e-6);
    EXPECT_FALSE(finest.readsCoarse);
    EXPECT_GT(finest.shareRead, 0.9);
}

// Of four textures in a room, by camera paths, gather rays and photons together.
double shareOfARoom(IntegratorKind integrator, bool filters) {
    SceneMaker maker;
    const auto checker = std::make_shared<Checker>(4, filters);
    maker.description.textures = checker;
    texturedQuad(maker, {-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, 1, textured(maker, 0));
    texturedQuad(maker, {-2, 0, -2}, {4, 0, 0}, {0, 3, 0}, 1, textured(maker, 1));
    texturedQuad(maker, {-2, 0, 2}, {0, 0, -4}, {0, 3, 0}, 1, textured(maker, 2));
    texturedQuad(maker, {2, 0, -2}, {0, 0, 4}, {0, 3, 0}, 1, textured(maker, 3));
    maker.quad({-1.2, 0.3, -1.9}, {1.4, 0, 0}, {0, 1.6, 0}, maker.material(mirror()));
    maker.quad({-0.5, 3, -0.5}, {1, 0, 0}, {0, 0, 1}, maker.diffuse({}, Rgb(10.0f)));
    maker.camera({0, 1.5, 5.5}, {0, 1.4, 0}, {0, 1, 0}, 40);
    measure(maker.build(), smallFrame(160, 120, integrator, 1, 1));
    return checker->shareRead();
}

// As many texels a pixel as 4096 x 4096 in 640 x 480.
TEST(Footprint, AFrameReadsATenthOfItsTextures) {
    EXPECT_LT(shareOfARoom(IntegratorKind::kPath, true), 0.1);
    EXPECT_LT(shareOfARoom(IntegratorKind::kPhoton, true), 0.1);
    EXPECT_GT(shareOfARoom(IntegratorKind::kPhoton, false), 0.9);
}

}  // namespace
}  // namespace pm::test
