// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Scene-linear picture -> view -> file -> codes, one file for each view.
#include <OpenImageIO/imageio.h>

#include <limits>

#include "host_shim/colour/colour_pipeline.h"
#include "host_shim/colour/display_picture.h"
#include "host_shim/pictures/picture_io.h"
#include "tests/colour/picture_compare.h"
#include "tests/colour/stored_ramps.h"

namespace pm::host::test {
namespace {

class EndToEnd : public ScratchTest {
  protected:
    std::vector<int> codes(const std::string& name) const {
        OIIO::ImageSpec wishes;
        wishes.attribute("oiio:UnassociatedAlpha", 1);
        const auto input = OIIO::ImageInput::open(file(name).string(), &wishes);
        if (!input) return {};
        std::vector<std::uint8_t> bytes(input->spec().image_bytes());
        input->read_image(0, 0, 0, -1, OIIO::TypeDesc::UINT8, bytes.data());
        return {bytes.begin(), bytes.end()};
    }
};

// The ramp's eight colours but for NaN, side by side, covered by alpha.
Picture rampPicture(float alpha) {
    const Ramp colours{{{0.18f, 0.18f, 0.18f},
                        {4, 4, 4},
                        {1, 0, 0},
                        {0, 1, 0},
                        {0, 0, 1},
                        {-0.5f, 0.2f, -0.1f},
                        {1e4f, 1e4f, 1e4f},
                        {0.18f, 0.18f, 0.18f}}};
    Picture picture{8, 1, {0, 0, 8, 1}, {}, {}};
    for (std::size_t c = 0; c < 3; ++c) {
        Channel channel{std::string(1, "RGB"[c]), true, {}};
        for (const auto& colour : colours) channel.values.push_back(colour[c] * alpha);
        picture.channels.push_back(channel);
    }
    picture.channels.push_back({"A", true, std::vector<float>(8, alpha)});
    return picture;
}

TEST_F(EndToEnd, OnePngForEachView) {
    std::size_t views = 0;
    for (const StoredRamp& stored : storedRamps()) {
        if (*stored.config != '\0') continue;
        SCOPED_TRACE(std::string(stored.display) + " / " + stored.view);
        const ColourPipeline colour({.renderingSpace = stored.renderingSpace,
                                     .display = stored.display,
                                     .view = stored.view});
        const std::string name = std::to_string(views++);
        const auto transform = colour.displayTransform();
        writeDisplayPicture(file(name + ".png"),
                            makeDisplayPicture(rampPicture(1), transform).picture);
        writeDisplayPicture(file(name + "a.png"),
                            makeDisplayPicture(rampPicture(0.5f), transform, true).picture);
        const auto opaque = codes(name + ".png"), covered = codes(name + "a.png");
        ASSERT_EQ(opaque.size(), 24u);
        ASSERT_EQ(covered.size(), 32u);
        for (std::size_t i = 0; i < 7 * 3; ++i) {
            const double expected = 255.0 * static_cast<double>(stored.expected[i / 3][i % 3]);
            EXPECT_NEAR(opaque[i], expected, 1.0) << i;
            EXPECT_NEAR(covered[i / 3 * 4 + i % 3], expected, 1.0) << i;
        }
        for (std::size_t i = 3; i < 32; i += 4) EXPECT_EQ(covered[i], 128);
    }
    EXPECT_EQ(views, 8u);
}

TEST_F(EndToEnd, TwoRunsGiveTheSameBytes) {
    for (const char* name : {"a", "b"}) {
        const ColourPipeline colour({.renderingSpace = "ACEScg"});
        Picture picture = rampPicture(1);
        const auto figures = *colour.chromaticities();
        picture.attributes["chromaticities"] = std::vector<float>(figures.begin(), figures.end());
        picture.attributes["colorInteropID"] = colour.colorInteropId();
        picture.attributes["pm:ocioCacheId"] = colour.cacheId();
        writeExr(file(std::string(name) + ".exr"), picture);
        writeDisplayPicture(file(std::string(name) + ".png"),
                            makeDisplayPicture(picture, colour.displayTransform()).picture);
    }
    EXPECT_EQ(readBytes(file("a.exr")), readBytes(file("b.exr")));
    EXPECT_EQ(readBytes(file("a.png")), readBytes(file("b.png")));
    EXPECT_TRUE(sameExr(file("a.exr").string(), file("b.exr").string()));
    const Picture back = readExr(file("a.exr"));
    EXPECT_EQ(std::get<std::string>(back.attributes.at("colorInteropID")), "lin_ap1_scene");
    EXPECT_EQ(std::get<std::vector<float>>(back.attributes.at("chromaticities"))[0], 0.713f);
}

TEST_F(EndToEnd, BadPixelsAreCountedAndShownBlack) {
    Picture picture = rampPicture(1);
    picture.channels[0].values[0] = std::numeric_limits<float>::quiet_NaN();
    picture.channels[1].values[1] = std::numeric_limits<float>::infinity();
    const ColourPipeline colour({.view = "raw"});
    const auto shown = makeDisplayPicture(picture, colour.displayTransform());
    EXPECT_EQ(shown.cleaning.nanCount, 1);
    EXPECT_EQ(shown.cleaning.infiniteCount, 1);
    EXPECT_EQ(shown.picture.values[0], 0.0f);
    EXPECT_EQ(shown.picture.values[4], 1.0f);
    picture.channels.erase(picture.channels.begin());
    EXPECT_TRUE(
        refusesWith(refusal([&] { makeDisplayPicture(picture, colour.displayTransform()); }), 1,
                    {"channel R"}));
}

TEST_F(EndToEnd, ACropShowsItsDataWindow) {
    Picture picture = rampPicture(1);
    picture.width = 100;
    picture.height = 50;
    picture.dataWindow = {10, 20, 14, 22};
    const auto shown =
        makeDisplayPicture(picture, ColourPipeline{ColourOptions{}}.displayTransform()).picture;
    EXPECT_EQ(shown.width, 4);
    EXPECT_EQ(shown.height, 2);
    EXPECT_EQ(shown.values.size(), 24u);
}

}  // namespace
}  // namespace pm::host::test
