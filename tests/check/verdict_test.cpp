// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// A picture against the stored one, measure by measure.
#include "host_shim/check/verdict.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace pm::host {
namespace {

constexpr PixelRect kWindow{0, 0, 48, 32};
constexpr float kNoise = 0.02f;

Picture render(unsigned seed, const std::string& build) {
    std::mt19937 random(seed);
    std::normal_distribution<float> noise(0.0f, kNoise);
    Picture picture{48, 32, kWindow, {}, {}};
    for (const char* name : {"R", "G", "B"}) {
        Channel& channel = picture.channels.emplace_back(Channel{name, true, {}});
        for (int i = 0; i < 48 * 32; ++i) channel.values.push_back(1 + noise(random));
    }
    for (const char* name : {"stderr.X", "stderr.Y", "stderr.Z"})
        picture.channels.push_back({name, false, std::vector<float>(48 * 32, kNoise)});
    picture.attributes = {{"pm:build", build},
                          {"pm:isa", std::string("avx2")},
                          {"pm:sceneHash", std::string("s")},
                          {"pm:settingsHash", std::string("t")},
                          {"pm:passesDone", std::string("4")},
                          {"colorInteropID", std::string("lin_rec709_scene")}};
    return picture;
}

class ComparePictures : public ::testing::Test {
  protected:
    ComparePictures() {
        for (unsigned seed = 1; seed <= 17; ++seed) m_renders.push_back(render(seed, "one"));
        m_reference.window = kWindow;
        for (const std::int32_t side : kRegionSides) {
            std::vector<std::vector<double>> means;
            for (const Picture& picture : m_renders)
                means.push_back(RegionGrid(kWindow, side).means(beautyOf(picture)));
            m_reference.regions.push_back(spreadOf(kWindow, side, means));
        }
        m_reference.pixelLimit = 7;
    }
    Verdict verdict(const Picture& picture) const {
        return comparePictures(m_renders[0], picture, m_reference);
    }
    // The one finding that there is.
    void expectFinding(const Picture& picture, const std::string& measure,
                       const std::string& part) const {
        const Verdict result = verdict(picture);
        ASSERT_FALSE(result.findings.empty()) << measure;
        EXPECT_EQ(result.findings[0].measure, measure);
        EXPECT_NE(result.findings[0].text.find(part), std::string::npos) << result.findings[0].text;
    }
    std::vector<Picture> m_renders;
    Reference m_reference;
};

void brighten(Picture& picture, const PixelRect& rect, float factor) {
    for (std::size_t c = 0; c < 3; ++c)
        for (std::int32_t y = rect.y0; y < rect.y1; ++y)
            for (std::int32_t x = rect.x0; x < rect.x1; ++x)
                picture.channels[c].values[static_cast<std::size_t>(y * 48 + x)] *= factor;
}

TEST_F(ComparePictures, TheSameIsTheSame) {
    const Verdict result = verdict(m_renders[0]);
    EXPECT_TRUE(result.findings.empty());
    EXPECT_TRUE(result.isSameBuild);
    EXPECT_TRUE(result.hasSameBits);
}

TEST_F(ComparePictures, AnotherBuildMayHaveOtherNoise) {
    const Verdict result = verdict(render(99, "two"));
    EXPECT_TRUE(result.findings.empty());
    EXPECT_FALSE(result.isSameBuild);
    EXPECT_FALSE(result.hasSameBits);
    EXPECT_GT(result.shareOfLimit, 0);
}

TEST_F(ComparePictures, TheSameBuildMayNot) {
    Picture picture = m_renders[0];
    picture.channels[2].values[48 * 20 + 35] *= 1 + 1e-6f;
    expectFinding(picture, "bits", "1 values differ");
    expectFinding(picture, "bits", "B at 35,20");
}

TEST_F(ComparePictures, TwoPercentOfOneBlockAreFoundWhateverTheBuild) {
    Picture picture = render(99, "two");
    brighten(picture, {16, 0, 32, 16}, 1.02f);
    const Verdict result = verdict(picture);
    ASSERT_FALSE(result.findings.empty());
    EXPECT_EQ(result.findings[0].measure, "region");
    EXPECT_NE(result.findings[0].text.find("region 16,0 to 32,16"), std::string::npos)
        << result.findings[0].text;
}

TEST_F(ComparePictures, AStoredPictureThatWasEditedIsNamed) {
    Picture edited = m_renders[0];
    brighten(edited, {32, 16, 48, 32}, 1.02f);
    const Verdict result = comparePictures(edited, render(99, "two"), m_reference);
    ASSERT_FALSE(result.findings.empty());
    EXPECT_EQ(result.findings[0].measure, "reference");
    EXPECT_NE(result.findings[0].text.find("region 32,16 to 48,32"), std::string::npos)
        << result.findings[0].text;
}

TEST_F(ComparePictures, OneBlackPixelIsFound) {
    Picture picture = render(99, "two");
    for (std::size_t c = 0; c < 3; ++c) picture.channels[c].values[48 * 9 + 7] = 0;
    expectFinding(picture, "pixel", "at 7,9 is 0");
}

TEST_F(ComparePictures, ShapeAndMetadataComeFirst) {
    Picture picture = render(99, "two");
    picture.channels[0].values[5] = std::numeric_limits<float>::quiet_NaN();
    expectFinding(picture, "not finite", "R at 5,0");
    picture = render(99, "two");
    picture.width = 49;
    expectFinding(picture, "size", "49x32 in place of 48x32");
    picture = render(99, "two");
    picture.dataWindow = {1, 0, 49, 32};
    expectFinding(picture, "data window", "1,0 to 49,32");
    picture = render(99, "two");
    picture.channels.pop_back();
    expectFinding(picture, "channels", "stderr.Y in place of");
    picture = render(99, "two");
    picture.attributes["colorInteropID"] = std::string("lin_ap1_scene");
    expectFinding(picture, "colour metadata", "colorInteropID is 'lin_ap1_scene'");
}

}  // namespace
}  // namespace pm::host
