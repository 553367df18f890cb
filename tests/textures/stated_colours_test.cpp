// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What pictures of codes say of their colours: chunks of PNG, embedded profiles.
#include <cmath>

#include "tests/textures/png_chunks.h"
#include "tests/textures/texture_support.h"

namespace pm::host::test {
namespace {

using OIIO::TypeDesc;

constexpr double kCode = 128.0 / 255;
constexpr float kOfSrgb = 0.215861f;  // light of code 128
constexpr std::array kRec709{0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290};
constexpr std::array kP3{0.68, 0.32, 0.265, 0.69, 0.15, 0.06, 0.3127, 0.3290};

class StatedColours : public TextureTest {
  protected:
    // A texel of these codes, as a PNG with these chunks.
    std::filesystem::path png(const std::string& name, const std::vector<Chunk>& chunks,
                              const std::vector<float>& codes = {128, 128, 128}) const {
        const auto path = file(name + ".png");
        std::vector<float> values;
        for (const float code : codes) values.push_back(code / 255);
        writeTexture(path, 1, 1, static_cast<int>(values.size()), TypeDesc::UINT8, values);
        setChunks(path, chunks);
        return path;
    }
    void expectGrey(const std::string& name, const std::vector<Chunk>& chunks, double light,
                    double tolerance = 2e-4) const {
        const auto values = texels({png(name, chunks)});
        ASSERT_EQ(values.size(), 3u) << name;
        for (const float value : values) EXPECT_NEAR(value, light, tolerance) << name;
    }
    void expectTexel(const TextureRequest& request, std::array<float, 3> right,
                     float tolerance) const {
        const auto values = texels(request);
        ASSERT_EQ(values.size(), 3u) << request.file;
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(values[c], right[c], tolerance) << request.file << " " << c;
    }
};

TEST_F(StatedColours, GammaOfAPng) {
    expectGrey("none", {}, kOfSrgb);
    expectGrey("linear", {gamma(1)}, kCode);
    expectGrey("mac", {gamma(0.55556)}, std::pow(kCode, 1.8));
    expectGrey("bright", {gamma(0.4)}, std::pow(kCode, 2.5));
    expectGrey("srgb", {gamma(0.45455)}, kOfSrgb);
    expectGrey("rounded", {gamma(0.45)}, kOfSrgb);
    expectGrey("zero", {gamma(0)}, kOfSrgb);
}

TEST_F(StatedColours, SrgbComesBeforeGammaAndAProfileBeforeBoth) {
    const Chunk srgb{"sRGB", std::string(1, '\0')};
    expectGrey("both", {gamma(1), srgb}, kOfSrgb);
    expectGrey("other_order", {srgb, gamma(1), primaries(kP3)}, kOfSrgb);
    const Chunk linear = profile(rgbProfile(kSrgbColumns, curveOfGamma(1)));
    expectGrey("profile", {gamma(0.55556), linear}, kCode);
    expectGrey("profile_first", {linear, gamma(0.55556), primaries(kP3)}, kCode);
}

TEST_F(StatedColours, DepthsAndGreyAndAlpha) {
    writeTexture(file("deep.png"), 1, 1, 3, TypeDesc::UINT16, {0.25f, 0.5f, 0.75f});
    setChunks(file("deep.png"), {gamma(1)});
    expectTexel({file("deep.png")}, {0.25f, 0.5f, 0.75f}, 2e-5f);
    EXPECT_NEAR(texels({png("grey", {gamma(0.55556)}, {128})})[0], std::pow(kCode, 1.8), 2e-4);
    EXPECT_EQ(texels({png("grey_p3", {gamma(1), primaries(kP3)}, {128})}).size(), 1u);
    expectTexel({png("alpha", {gamma(1)}, {128, 64, 0, 40})}, {0.50196f, 0.25098f, 0}, 2e-4f);
}

TEST_F(StatedColours, PrimariesOfAPng) {
    // Rec.709's, rounded: nothing is to be converted.
    auto close = kRec709;
    close[2] += 0.0009;
    close[5] -= 0.001;
    expectTexel({png("close", {gamma(1), primaries(close)}, {255, 0, 0})}, {1, 0, 0}, 1e-6f);
    // Display P3's red in Rec.709, from the two sets of primaries.
    const std::array<float, 3> red{1.2249f, -0.0420f, -0.0197f};
    expectTexel({png("p3", {gamma(1), primaries(kP3)}, {255, 0, 0})}, red, 2e-3f);
    expectTexel({png("p3_srgb", {gamma(0.45455), primaries(kP3)}, {255, 0, 0})}, red, 2e-3f);
    const float half = kOfSrgb;
    expectTexel({png("p3_half", {gamma(0.45455), primaries(kP3)}, {128, 0, 0})},
                {half * red[0], half * red[1], half * red[2]}, 2e-3f);
    // White stays white, whatever it was.
    auto warm = kRec709;
    warm[6] = 0.3457;
    warm[7] = 0.3585;
    expectGrey("warm", {gamma(1), primaries(warm)}, kCode);
    // On one line: no primaries.
    expectTexel(
        {png("line", {gamma(1), primaries({.1, .1, .2, .2, .3, .3, .3127, .329})}, {255, 0, 0})},
        {1, 0, 0}, 1e-6f);
}

TEST_F(StatedColours, NumbersAreNeverDecoded) {
    const auto number = png("number", {gamma(1 / 1.8), primaries(kP3)});
    EXPECT_FLOAT_EQ(texels({number, TextureKind::kData})[0], 128.0f / 255);
    EXPECT_FLOAT_EQ(texels({number, TextureKind::kMask})[0], 128.0f / 255);
}

TEST_F(StatedColours, OptionsComeBeforeWhatAFileSays) {
    const auto linear = png("linear", {gamma(1)});
    expectTexel({linear, TextureKind::kColour, "srgb_rec709_scene"}, {kOfSrgb, kOfSrgb, kOfSrgb},
                2e-4f);
    EXPECT_EQ(baked({linear}).space.decidedBy, "the file");
    EXPECT_EQ(baked({png("none", {})}).space.decidedBy, "default");
    m_colour = ColourPipeline({.textureSpace = "srgb_rec709_scene"});
    expectTexel({linear}, {kOfSrgb, kOfSrgb, kOfSrgb}, 2e-4f);
}

TEST_F(StatedColours, TheSameWhenNothingIsConverted) {
    const auto plain = texels({png("plain", {}, {10, 128, 250})});
    const Chunk srgb = profile(rgbProfile(
        kSrgbColumns, parametric(3, {2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045})));
    EXPECT_EQ(texels({png("chunk", {{"sRGB", std::string(1, '\0')}}, {10, 128, 250})}), plain);
    EXPECT_EQ(texels({png("gamma", {gamma(0.45455), primaries(kRec709)}, {10, 128, 250})}), plain);
    EXPECT_EQ(texels({png("profile", {srgb}, {10, 128, 250})}), plain);
}

TEST_F(StatedColours, ProfilesOfThreePrimaries) {
    const auto adobe =
        png("adobe", {profile(rgbProfile(kAdobeColumns, curveOfGamma(563.0 / 256)))}, {0, 255, 0});
    // Adobe RGB's green in Rec.709.
    expectTexel({adobe}, {-0.3984f, 1.0f, -0.0429f}, 3e-3f);
    EXPECT_EQ(baked({adobe}).profile, "");
    // ITU-R BT.709's camera curve, as a table.
    std::string table = std::string("curv\0\0\0\0", 8) + bigEndian(256);
    for (int i = 0; i < 256; ++i) {
        const double v = i / 255.0,
                     l = v < 0.081 ? v / 4.5 : std::pow((v + 0.099) / 1.099, 1 / 0.45);
        table += bigEndian(static_cast<std::uint32_t>(std::lround(l * 65535)), 2);
    }
    expectGrey("camera", {profile(rgbProfile(kSrgbColumns, table))},
               std::pow((kCode + 0.099) / 1.099, 1 / 0.45), 1e-3);
    const Chunk grey = profile(profileOf("GRAY", {{"kTRC", curveOfGamma(2)}}));
    EXPECT_NEAR(texels({png("grey", {grey}, {128})})[0], kCode * kCode, 2e-4);
}

TEST_F(StatedColours, ProfilesOfOtherFormats) {
    const std::string bytes = rgbProfile(kSrgbColumns, curveOfGamma(1));
    for (const char* name : {"profile.tif", "profile.jpg"}) {
        OIIO::ImageSpec spec(8, 8, 3, TypeDesc::UINT8);
        spec.attribute("ICCProfile", TypeDesc(TypeDesc::UINT8, static_cast<int>(bytes.size())),
                       bytes.data());
        writePicture(file(name), spec, std::vector<float>(8 * 8 * 3, 128.0f / 255));
        EXPECT_NEAR(texels({file(name)})[0], kCode, 1e-3) << name;
    }
}

// sRGB is taken, and the profile is told.
TEST_F(StatedColours, ProfilesThatAreNotUnderstood) {
    const std::string whole = rgbProfile(kSrgbColumns, curveOfGamma(1));
    std::string steps = std::string("curv\0\0\0\0", 8) + bigEndian(4);
    for (const std::uint32_t value : {0u, 60000u, 100u, 65535u}) steps += bigEndian(value, 2);
    const std::vector<std::pair<std::string, std::string>> kinds{
        {"no_tags", profileOf("RGB ", {})},
        {"steps", rgbProfile(kSrgbColumns, steps)},
        {"not_white", rgbProfile({.1, .1, .1, .1, .1, .1, .1, .1, .1}, curveOfGamma(1))},
        {"beyond", rgbProfile(kSrgbColumns, std::string("curv\0\0\0\0\xff\xff\xff\xff", 12))}};
    for (const auto& [name, bytes] : kinds) {
        expectGrey(name, {profile(bytes)}, kOfSrgb);
        EXPECT_NE(baked({file(name + ".png")}).profile, "") << name;
    }
    for (std::size_t size = 0; size < whole.size(); size += 31)
        baked({png("cut", {profile(whole.substr(0, size))})});
}

// Chunks that are broken or cut short are none.
TEST_F(StatedColours, BrokenChunks) {
    expectGrey("short", {{"gAMA", "ab"}}, kOfSrgb);
    expectGrey("short_primaries", {{"cHRM", "abcd"}}, kOfSrgb);
}

}  // namespace
}  // namespace pm::host::test
