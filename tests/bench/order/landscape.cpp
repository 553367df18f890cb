// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <array>
#include <cmath>

#include "tests/bench/order/cache_scenes.h"
#include "tests/support/limit_scene.h"

namespace pm::bench {

namespace {

constexpr int kFaces = 64;           // along each side
constexpr double kSide = 64.0;       // scene units
constexpr double kHeight = 7.0;      // of the highest hill
constexpr std::uint32_t kRate = 16;  // pieces of an edge

// Heights in [0, 1]: octaves of value noise.
class Hills final : public TextureSource {
  public:
    Texel lookUp(std::int32_t, const TextureContext& at) const override {
        const Vec2f uv = at.uv;
        float height = 0, size = 0.5f, frequency = 3.0f;
        for (std::uint32_t octave = 0; octave < 8; ++octave) {
            height += size * noise(uv.x * frequency, uv.y * frequency, octave);
            size *= 0.5f;
            frequency *= 2.0f;
        }
        return {height, height, height};
    }
    std::array<float, 2> extremes(std::int32_t, const CancelCheck&) const override {
        return {0.0f, 1.0f};
    }
    std::array<std::uint32_t, 2> texels(std::int32_t) const override { return {4096, 4096}; }
    std::uint64_t failureCount() const override { return 0; }

  private:
    static float corner(std::int32_t x, std::int32_t y, std::uint32_t octave) {
        std::uint32_t h = static_cast<std::uint32_t>(x) * 0x9e3779b9u +
                          static_cast<std::uint32_t>(y) * 0x85ebca6bu + octave * 0xc2b2ae35u;
        h = (h ^ (h >> 16)) * 0x7feb352du;
        h = (h ^ (h >> 15)) * 0x846ca68bu;
        return static_cast<float>((h ^ (h >> 16)) >> 8) * 0x1p-24f;
    }
    static float noise(float x, float y, std::uint32_t octave) {
        const float x0 = std::floor(x), y0 = std::floor(y);
        const auto ease = [](float t) { return t * t * (3.0f - 2.0f * t); };
        const float s = ease(x - x0), t = ease(y - y0);
        const auto i = static_cast<std::int32_t>(x0), j = static_cast<std::int32_t>(y0);
        const float low = std::lerp(corner(i, j, octave), corner(i + 1, j, octave), s);
        const float high = std::lerp(corner(i, j + 1, octave), corner(i + 1, j + 1, octave), s);
        return std::lerp(low, high, t);
    }
};

SubdivisionCage ground() {
    SubdivisionCage cage;
    PolygonMesh& mesh = cage.mesh;
    const auto at = [](int x, int y) { return static_cast<std::uint32_t>(y * (kFaces + 1) + x); };
    for (int y = 0; y <= kFaces; ++y) {
        for (int x = 0; x <= kFaces; ++x) {
            const float u = static_cast<float>(x) / kFaces, v = static_cast<float>(y) / kFaces;
            mesh.positions.emplace_back(static_cast<float>(kSide) * (u - 0.5f), 0.0f,
                                        static_cast<float>(kSide) * (0.5f - v));
            mesh.texcoords.emplace_back(u, v);
        }
    }
    for (int y = 0; y < kFaces; ++y) {
        for (int x = 0; x < kFaces; ++x) {
            mesh.faceVertexCounts.push_back(4);
            for (const std::uint32_t vertex :
                 {at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)}) {
                mesh.vertexIndices.push_back(vertex);
                mesh.texcoordIndices.push_back(static_cast<std::int32_t>(vertex));
            }
        }
    }
    return cage;
}

}  // namespace

CacheScene landscape(std::int32_t side) {
    test::SceneMaker maker;
    maker.description.textures = std::make_shared<const Hills>();
    MaterialDescription hills;
    hills.diffuse = {0.35f, 0.4f, 0.25f};
    hills.displacementTexture = 0;
    hills.displacementScale = static_cast<float>(kHeight);
    test::addLimit(maker, ground(), kRate, maker.material(hills));
    maker.sun({-0.5, -0.45, -0.4}, Rgb(2.5f, 2.2f, 1.8f), 0.0047);
    maker.sky(Rgb(0.3f, 0.4f, 0.6f));
    maker.camera({0, 6.5, 30}, {2, 3.5, 0}, {0, 1, 0}, 45);
    CacheScene made;
    made.name = "landscape";
    made.unit = "groups of triangles";
    made.scene = maker.build();
    made.settings = test::smallFrame(side, side, IntegratorKind::kPhoton, 1, 2);
    made.settings.photons = 100'000;
    made.empty = [scene = made.scene] { scene->setGroupBudget(0); };
    made.setBudget = [scene = made.scene](std::uint64_t bytes) { scene->setGroupBudget(bytes); };
    made.misses = [scene = made.scene] { return scene->groupCounts().misses; };
    made.groups = made.scene->groupCache();
    return made;
}

}  // namespace pm::bench
