// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "integrator/caches/cache_watch.h"
#include "plugin/textures/scene_textures.h"
#include "plugin/textures/watched_input.h"
#include "tests/bench/order/cache_scenes.h"
#include "tests/support/scene_maker.h"

namespace pm::bench {

namespace {

constexpr std::uint32_t kTexels = 2048, kTile = 64, kPanels = 24;
// Tells the thread's watch which tiles a look-up reads.
class ToldTextures final : public TextureSource {
  public:
    explicit ToldTextures(std::vector<std::string> files) : m_files(std::move(files)) { reopen(); }
    // From here on nothing is held. No look-up meanwhile.
    void reopen() {
        m_system = std::make_shared<plugin::TextureSystem>();
        m_textures = std::make_unique<plugin::SceneTextures>();
        for (const std::string& file : m_files) {
            plugin::TextureDescription description;
            description.fileName = file;
            auto texture = std::make_shared<plugin::Texture>();
            texture->system = m_system;
            texture->picture = m_system->open(description);
            m_textures->add(texture);
        }
    }
    void holdAtMost(std::uint64_t bytes) { m_system->holdAtMost(bytes); }

    Texel lookUp(std::int32_t index, const TextureContext& at) const override {
        if (CacheWatch* const watch = CacheWatch::current()) tell(*watch, index, at.uv);
        return m_textures->lookUp(index, at);
    }
    std::array<std::uint32_t, 2> texels(std::int32_t index) const override {
        return m_textures->texels(index);
    }
    std::uint64_t failureCount() const override { return m_textures->failureCount(); }
    std::uint64_t misses() const { return m_textures->reads().tiles; }

  private:
    // The tiles of the four texels around a place, of the only level.
    void tell(CacheWatch& watch, std::int32_t index, Vec2f uv) const {
        constexpr std::uint32_t kTilesAcross = kTexels / kTile;
        std::uint64_t last = ~std::uint64_t{0};
        for (const float dy : {-0.5f, 0.5f}) {
            for (const float dx : {-0.5f, 0.5f}) {
                const auto tileAt = [](float place) {
                    const auto texel = static_cast<std::int32_t>(std::floor(place));
                    return (static_cast<std::uint32_t>(texel) % kTexels) / kTile;
                };
                const std::uint64_t key = (static_cast<std::uint64_t>(index) * kTilesAcross +
                                           tileAt(uv.y * kTexels + dy)) *
                                              kTilesAcross +
                                          tileAt(uv.x * kTexels + dx);
                if (key != last) watch.asked({m_cache, key, kTileBytes, false, CacheWatch::user()});
                last = key;
            }
        }
    }

    static constexpr std::uint64_t kTileBytes = std::uint64_t{3} * kTile * kTile;
    std::vector<std::string> m_files;
    std::shared_ptr<plugin::TextureSystem> m_system;
    std::unique_ptr<plugin::SceneTextures> m_textures;
    std::uint32_t m_cache = CacheWatch::newCache();
};

void writePicture(const std::filesystem::path& file, std::uint32_t number) {
    OIIO::ImageSpec spec(kTexels, kTexels, 3, OIIO::TypeDesc::UINT8);
    spec.tile_width = spec.tile_height = kTile;
    spec.attribute("compression", "none");
    std::vector<std::uint8_t> texels(std::size_t{3} * kTexels * kTexels);
    for (std::uint32_t y = 0, i = 0; y < kTexels; ++y) {
        for (std::uint32_t x = 0; x < kTexels; ++x) {
            const std::uint32_t grain = (x * 0x9e3779b9u ^ y * 0x85ebca6bu ^ number) * 0x7feb352du;
            const std::uint32_t brick = ((x / 128 + (y / 64 % 2) / 2) ^ (y / 64)) % 5;
            for (std::uint32_t c = 0; c < 3; ++c)
                texels[i++] = static_cast<std::uint8_t>(90 + brick * (8 + (number * (c + 3)) % 17) +
                                                        (grain >> 28));
        }
    }
    const auto out = OIIO::ImageOutput::create("tiff");
    if (!out || !out->open(file.string(), spec) ||
        !out->write_image(OIIO::TypeDesc::UINT8, texels.data()) || !out->close())
        throw std::runtime_error(fmt::format("{}: {}", file.string(), OIIO::geterror()));
}

void addLevels(const std::string& from, const std::string& to) {
    OIIO::ImageSpec config;
    config.tile_width = config.tile_height = kTile;
    config.attribute("compression", "none");
    if (!OIIO::ImageBufAlgo::make_texture(OIIO::ImageBufAlgo::MakeTxTexture, from, to, config))
        throw std::runtime_error(fmt::format("{}: {}", to, OIIO::geterror()));
}

// Two by two panels on each side of a cube around the origin, each of a material of its own.
void addPanels(test::SceneMaker& maker) {
    constexpr std::array<std::array<Vec3d, 3>, 6> kSides{{
        {{{-1, -1, -1}, {2, 0, 0}, {0, 2, 0}}},
        {{{1, -1, 1}, {-2, 0, 0}, {0, 2, 0}}},
        {{{-1, -1, 1}, {0, 0, -2}, {0, 2, 0}}},
        {{{1, -1, -1}, {0, 0, 2}, {0, 2, 0}}},
        {{{-1, -1, 1}, {2, 0, 0}, {0, 0, -2}}},
        {{{-1, 1, -1}, {2, 0, 0}, {0, 0, 2}}},
    }};
    std::int32_t texture = 0;
    for (const auto& [corner, across, up] : kSides) {
        for (int quarter = 0; quarter < 4; ++quarter) {
            const Vec3d a = across * 0.5, b = up * 0.5;
            const Vec3d p = corner + a * (quarter % 2) + b * (quarter / 2);
            TriangleMesh mesh;
            for (const Vec3d& position : {p, p + a, p + a + b, p + b})
                mesh.positions.emplace_back(position);
            mesh.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
            mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
            mesh.texcoordIndices = mesh.triangles;
            mesh.materials = {0, 0};
            mesh.faces = {0, 0};
            MaterialDescription panel;
            panel.diffuse = {1, 1, 1};
            panel.diffuseTexture = texture++;
            maker.mesh(std::move(mesh), maker.material(panel));
        }
    }
}

}  // namespace

namespace {

CacheScene roomOf(std::int32_t side, std::vector<std::string> files) {
    const auto told = std::make_shared<ToldTextures>(std::move(files));
    test::SceneMaker maker;
    maker.description.textures = told;
    addPanels(maker);
    maker.quad({-0.3, 0.98, 0.3}, {0, 0, -0.6}, {0.6, 0, 0}, maker.diffuse({}, Rgb(8.0f)));
    maker.sphere({-0.4, -0.65, -0.35}, 0.35, maker.diffuse(Rgb(0.6f)));
    maker.camera({0.0, 0.0, 0.95}, {0.0, -0.1, -1.0}, {0, 1, 0}, 80);
    CacheScene made;
    made.name = "room";
    made.unit = "tiles";
    made.scene = maker.build();
    made.settings = test::smallFrame(side, side, IntegratorKind::kPhoton, 1, 2);
    made.settings.photons = 100'000;
    made.empty = [told] { told->reopen(); };
    made.setBudget = [told](std::uint64_t bytes) { told->holdAtMost(bytes); };
    made.misses = [told] { return told->misses(); };
    made.untraced = plugin::texelCache();
    made.leastBudget = plugin::TextureSystem::kLeastBytes;
    return made;
}

}  // namespace

CacheScene texturedRoom(std::int32_t side, const std::filesystem::path& folder) {
    std::vector<std::string> files, withLevels;
    for (std::uint32_t i = 0; i < kPanels; ++i) {
        const auto file = folder / fmt::format("panel{}.tif", i);
        if (!exists(file)) writePicture(file, i);
        files.push_back(file.string());
        withLevels.push_back((folder / fmt::format("panel{}.tx", i)).string());
    }
    CacheScene made = roomOf(side, files);
    made.remedy = "pictures with levels, for wide rays";
    made.remedied = [side, files, withLevels] {
        for (std::uint32_t i = 0; i < kPanels; ++i)
            if (!std::filesystem::exists(withLevels[i])) addLevels(files[i], withLevels[i]);
        return roomOf(side, withLevels);
    };
    return made;
}

}  // namespace pm::bench
