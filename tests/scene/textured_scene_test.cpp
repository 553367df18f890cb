// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Pictures that scenes name, from the file to what is seen: normal maps of each depth, skies.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <array>
#include <functional>

#include "tests/scene/host_test.h"
#include "tests/scene/picture_measures.h"

namespace pm::host::test {
namespace {

using OIIO::TypeDesc;

// A quad of side 2 that fills the frame, facing the camera.
constexpr const char* kQuad =
    "mtllib s.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl "
    "m\nf 1/1 2/2 3/3 4/4\n";
const Arguments kFront{"--eye", "0,0,10", "--look-at", "0,0,0",    "--fov",
                       "11.4",  "--size", "4x4",       "--passes", "1"};

class TexturedScene : public HostTest {
  protected:
    // All texels alike, but for rows, from above, that say otherwise.
    void picture(const std::string& name, TypeDesc type,
                 const std::function<std::array<float, 3>(int row)>& colour, int rows = 4) {
        OIIO::ImageSpec spec(2 * rows, rows, 3, type);
        std::vector<float> values;
        for (int row = 0; row < rows; ++row)
            for (int column = 0; column < 2 * rows; ++column) {
                const auto c = colour(row);
                values.insert(values.end(), c.begin(), c.end());
            }
        const std::string path = (m_folder / name).string();
        const auto output = OIIO::ImageOutput::create(path);
        ASSERT_TRUE(output && output->open(path, spec)) << path;
        ASSERT_TRUE(output->write_image(TypeDesc::FLOAT, values.data()));
        ASSERT_TRUE(output->close());
    }
    std::array<double, 3> normalSeen(const std::string& material, const Arguments& more = {}) {
        write("s.obj", kQuad);
        write("s.mtl", "newmtl m\nKd 1 1 1\n" + material + "\n");
        const Picture seen = renderExr("s", Arguments{"s.obj", "--aov", "N"} + kFront + more);
        std::array<double, 3> normal{};
        for (std::size_t i = 0; i < 3; ++i)
            for (const auto& channel : seen.channels)
                if (channel.name == std::string("N.") + "XYZ"[i])
                    normal[i] = static_cast<double>(channel.values.at(0));
        return normal;
    }
};

TEST_F(TexturedScene, FlatNormalMapsOfAllDepthsAreFlat) {
    const std::array<double, 3> flat{0, 0, 1};
    const auto grey = [](float v) { return [v](int) { return std::array{v, v, 1.0f}; }; };
    picture("8.png", TypeDesc::UINT8, grey(128.0f / 255));
    picture("16.png", TypeDesc::UINT16, grey(32768.0f / 65535));
    picture("f.exr", TypeDesc::FLOAT, grey(0.5f));
    picture("h.exr", TypeDesc::HALF, grey(0.5f));
    for (const char* name : {"8.png", "16.png", "f.exr", "h.exr"})
        EXPECT_EQ(normalSeen(std::string("norm ") + name), flat) << name;
    // The same slope by each depth: .6 along u, .8 out.
    picture("s16.png", TypeDesc::UINT16, [](int) { return std::array{0.8f, 0.5f, 0.9f}; });
    picture("sf.exr", TypeDesc::FLOAT, [](int) { return std::array{0.8f, 0.5f, 0.9f}; });
    for (const char* name : {"s16.png", "sf.exr"}) {
        const auto normal = normalSeen(std::string("norm ") + name);
        EXPECT_NEAR(normal[0], 0.6, 1e-4) << name;
        EXPECT_NEAR(normal[1], 0, 1e-4) << name;
        EXPECT_NEAR(normal[2], 0.8, 1e-4) << name;
    }
}

TEST_F(TexturedScene, BumpMapsThatLookLikeNormalMapsAreTold) {
    picture("n.png", TypeDesc::UINT8, [](int) { return std::array{0.8f, 0.5f, 0.9f}; });
    EXPECT_EQ(normalSeen("map_Bump n.png"), (std::array<double, 3>{0, 0, 1}));
    EXPECT_EQ(m_warnings.find("--bump-is-normal"), std::string::npos) << "it leans on the average";
    picture(
        "flat.png", TypeDesc::UINT8,
        [](int row) {
            return std::array{0.5f, row < 8 ? 0.8f : 0.2f, 0.9f};
        },
        16);
    normalSeen("map_Bump flat.png");
    EXPECT_NE(m_warnings.find("--bump-is-normal"), std::string::npos) << m_warnings;
    EXPECT_NE(m_warnings.find("flat.png"), std::string::npos) << m_warnings;
    EXPECT_GT(normalSeen("map_Bump flat.png", {"--bump-is-normal"})[1], 0.4);
    EXPECT_EQ(m_warnings.find("--bump-is-normal"), std::string::npos) << m_warnings;
}

// Pictures whose alpha nobody asked for: told, and used where that is asked for; what is black
// where it is to be seen through doesn't brighten the rest.
TEST_F(TexturedScene, AlphaOfPicturesIsToldAndTaken) {
    constexpr int kSide = 64;
    const auto withAlpha = [&](const std::string& name, TypeDesc type, float alpha) {
        OIIO::ImageSpec spec(kSide, kSide, 4, type);
        std::vector<float> values;
        for (int i = 0; i < kSide * kSide; ++i) {
            const bool isLeft = i % kSide < kSide / 2;
            const float v = isLeft ? 0.5f : 0.0f;
            values.insert(values.end(), {v, v, v, isLeft ? 1.0f : alpha});
        }
        const auto output = OIIO::ImageOutput::create((m_folder / name).string());
        ASSERT_TRUE(output && output->open((m_folder / name).string(), spec)) << name;
        ASSERT_TRUE(output->write_image(TypeDesc::FLOAT, values.data()) && output->close());
    };
    const auto coverage = [&](const std::string& maps, const Arguments& more) {
        write("s.obj", kQuad);
        write("s.mtl", "newmtl m\nKd 1 1 1\n" + maps + "\n");
        const Picture seen = renderExr("s", Arguments{"s.obj"} + kFront + more);
        const Channel* const alpha = seen.find("A");
        double sum = 0;
        if (alpha != nullptr)
            for (const float value : alpha->values) sum += static_cast<double>(value);
        return sum / (4 * 4);
    };
    const std::string word = "--alpha-of-pictures";
    withAlpha("8.png", TypeDesc::UINT8, 0);
    withAlpha("16.png", TypeDesc::UINT16, 0);
    withAlpha("f.exr", TypeDesc::FLOAT, 0);
    withAlpha("opaque.png", TypeDesc::UINT8, 1);
    for (const std::string name : {"8.png", "16.png", "f.exr"}) {
        EXPECT_NEAR(coverage("map_Kd " + name, {}), 1, 1e-6) << name;
        EXPECT_NE(m_warnings.find(word), std::string::npos) << name << m_warnings;
        EXPECT_NEAR(coverage("map_Kd " + name, {word}), 0.5, 0.1) << name;
        EXPECT_EQ(m_warnings.find(word), std::string::npos) << name << m_warnings;
    }
    for (const std::string maps : {"map_Kd opaque.png", "map_Kd 8.png\nmap_d opaque.png"}) {
        EXPECT_NEAR(coverage(maps, {}), 1, 1e-6) << maps;
        EXPECT_EQ(m_warnings.find(word), std::string::npos) << maps << m_warnings;
        EXPECT_NEAR(coverage(maps, {word}), 1, 1e-6) << maps;
    }
}

// Straight up there is nothing of the lowest row, straight down nothing of the uppermost one.
TEST_F(TexturedScene, SkiesEndAtTheirPoles) {
    write("s.obj", "v 90 0 0\nv 91 0 0\nv 90 0 1\nf 1 2 3\n");
    for (const int rows : {2, 32, 128}) {
        picture(
            "sky.exr", TypeDesc::FLOAT,
            [&](int row) {
                const float v = 2 * row < rows ? 1.0f : 0.0f;
                return std::array{v, v, v};
            },
            rows);
        const auto seen = [&](const char* at) {
            return meansOf(
                renderExr("s", {"s.obj", "--environment", "sky.exr", "--eye", "0,0,0", "--look-at",
                                at, "--fov", "1", "--size", "4x4", "--passes", "1"}),
                "")[0];
        };
        EXPECT_NEAR(seen(".0001,-3,0"), 0, 1e-6) << rows;
        EXPECT_NEAR(seen(".0001,3,.0001"), 1, 1e-6) << rows;
    }
}

}  // namespace
}  // namespace pm::host::test
