// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <OpenImageIO/imageio.h>

#include <cmath>
#include <limits>

#include "host_shim/pictures/picture_io.h"
#include "tests/colour/scratch.h"

namespace pm::host::test {
namespace {

class DisplayWrite : public ScratchTest {
  protected:
    // The codes as they lie in the file, alpha straight.
    template <typename Code>
    std::vector<Code> codes(const std::string& name, OIIO::TypeDesc type) const {
        OIIO::ImageSpec wishes;
        wishes.attribute("oiio:UnassociatedAlpha", 1);
        const auto input = OIIO::ImageInput::open(file(name).string(), &wishes);
        if (!input || input->spec().format != type) return {};
        std::vector<Code> values(input->spec().image_pixels() *
                                 static_cast<std::size_t>(input->spec().nchannels));
        if (!input->read_image(0, 0, 0, -1, type, values.data())) return {};
        return values;
    }
};

// (k + d) / 255 for d just under and over the middle between two codes.
DisplayPicture roundingPicture() {
    DisplayPicture picture{4, 1, 3, {}};
    picture.values = {
        0.0f,          1.0f,          0.5f,        10.49f / 255,
        10.51f / 255,  -1.0f,         2.0f,        std::numeric_limits<float>::quiet_NaN(),
        254.49f / 255, 254.51f / 255, 0.49f / 255, 0.51f / 255};
    return picture;
}
const std::vector<std::uint8_t> kRounded{0, 255, 128, 10, 11, 0, 255, 0, 254, 255, 0, 1};

TEST_F(DisplayWrite, EightBitRoundsToTheNearest) {
    for (const char* name : {"a.png", "a.tif", "b.TIFF"}) {
        writeDisplayPicture(file(name), roundingPicture());
        EXPECT_EQ(codes<std::uint8_t>(name, OIIO::TypeDesc::UINT8), kRounded) << name;
    }
    EXPECT_EQ(listing(), "a.png a.tif b.TIFF");
}

TEST_F(DisplayWrite, SixteenBit) {
    DisplayPicture picture{1, 1, 3, {0.18f, 0.5f, 1.0f}};
    for (const char* name : {"a.tif", "a.png"}) {
        writeDisplayPicture(file(name), picture, {.bitDepth = 16});
        EXPECT_EQ(codes<std::uint16_t>(name, OIIO::TypeDesc::UINT16),
                  (std::vector<std::uint16_t>{11796, 32768, 65535}));
    }
    EXPECT_TRUE(
        refusesWith(refusal([&] { writeDisplayPicture(file("a.jpg"), picture, {.bitDepth = 16}); }),
                    2, {"16", "allowed"}));
}

TEST_F(DisplayWrite, PngKeepsStraightAlpha) {
    DisplayPicture picture{2, 1, 4, {0.8f, 0.4f, 0.2f, 0.5f, 1.0f, 1.0f, 1.0f, 0.0f}};
    for (const char* name : {"a.png", "a.tif"}) {
        writeDisplayPicture(file(name), picture);
        EXPECT_EQ(codes<std::uint8_t>(name, OIIO::TypeDesc::UINT8),
                  (std::vector<std::uint8_t>{204, 102, 51, 128, 255, 255, 255, 0}))
            << name;
    }
}

TEST_F(DisplayWrite, JpegIsOverBlack) {
    DisplayPicture picture{16, 16, 4, {}};
    for (int i = 0; i < 256; ++i) picture.values.insert(picture.values.end(), {1, 1, 1, 0.5f});
    writeDisplayPicture(file("a.jpg"), picture);
    const auto values = codes<std::uint8_t>("a.jpg", OIIO::TypeDesc::UINT8);
    ASSERT_EQ(values.size(), 768u);
    for (const std::uint8_t value : values) EXPECT_NEAR(value, 128, 1);
}

TEST_F(DisplayWrite, TwoRunsGiveTheSameBytes) {
    for (const std::string extension : {".png", ".jpg", ".tif"}) {
        writeDisplayPicture(file("a" + extension), roundingPicture());
        writeDisplayPicture(file("b" + extension), roundingPicture());
        EXPECT_EQ(readBytes(file("a" + extension)), readBytes(file("b" + extension))) << extension;
        EXPECT_FALSE(readBytes(file("a" + extension)).empty());
    }
}

TEST_F(DisplayWrite, UnknownFormatsAreWrongUsage) {
    for (const char* name : {"a.gif", "a", "a.exr.bak"}) {
        EXPECT_TRUE(refusesWith(refusal([&] { pictureFormat(name); }), 2, {name, ".exr", ".tif"}));
    }
    EXPECT_EQ(&pictureFormat("x/A.EXR"), &pictureFormat("b.exr"));
    EXPECT_FALSE(isDisplayReferred(pictureFormat("x/A.EXR")));
    EXPECT_TRUE(isDisplayReferred(pictureFormat("a.JPEG")));
}

}  // namespace
}  // namespace pm::host::test
