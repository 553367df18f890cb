// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <OpenImageIO/imageio.h>

#include <cmath>

#include "host_shim/pictures/picture_io.h"
#include "tests/colour/picture_compare.h"
#include "tests/colour/test_pictures.h"

namespace pm::host::test {
namespace {

class Exr : public ScratchTest {};

const std::vector<std::string> kAllChannels{
    "R",        "G",        "B",   "A",   "direct.R", "direct.G", "direct.B", "albedo.R",
    "albedo.G", "albedo.B", "N.X", "N.Y", "N.Z",      "Z",        "stderr.X", "samples.X"};

Picture fullPicture() {
    Picture picture = gradientPicture(40, 30, {-3, -2, 45, 33}, kAllChannels);
    picture.attributes["chromaticities"] =
        std::vector<float>{0.713f, 0.293f, 0.165f, 0.83f, 0.128f, 0.044f, 0.32168f, 0.33767f};
    picture.attributes["colorInteropID"] = std::string("lin_ap1_scene");
    picture.attributes["pm:seed"] = std::string("18446744073709551615");
    picture.attributes["pm:passes"] = 4;
    picture.attributes["pm:relMse"] = 0.125f;
    picture.attributes["pm:version"] = std::string("0.1.0");
    return picture;
}

TEST_F(Exr, EverythingComesBack) {
    const Picture picture = fullPicture();
    writeExr(file("a.exr"), picture);
    const Picture back = readExr(file("a.exr"));
    for (const auto& [name, value] : picture.attributes) {
        ASSERT_TRUE(back.attributes.contains(name)) << name;
        EXPECT_EQ(back.attributes.at(name), value) << name;
    }
    PictureTolerance free;
    for (const auto& [name, value] : back.attributes) {
        if (!picture.attributes.contains(name)) free.freeAttributes.insert(name);
    }
    EXPECT_TRUE(samePicture(picture, back, free));
    EXPECT_EQ(listing(), "a.exr");
}

TEST_F(Exr, IsOneScanlineZipPartOfFloats) {
    writeExr(file("a.exr"), fullPicture());
    const auto input = OIIO::ImageInput::open(file("a.exr").string());
    ASSERT_TRUE(input);
    const OIIO::ImageSpec& spec = input->spec();
    EXPECT_EQ(spec.get_string_attribute("compression"), "zip");
    EXPECT_EQ(spec.tile_width, 0);
    EXPECT_EQ(spec.format, OIIO::TypeDesc::FLOAT);
    EXPECT_TRUE(spec.channelformats.empty());
    EXPECT_FALSE(input->seek_subimage(1, 0));
}

TEST_F(Exr, HalfIsForColourOnlyAndNeverInfinite) {
    Picture picture = fullPicture();
    picture.channels[0].values[0] = 1e9f;
    picture.channels[13].values[0] = 1e10f;  // Z where nothing is hit
    EXPECT_EQ(writeExr(file("a.exr"), picture, {.halfColour = true}).clampedToHalf, 1);
    const auto input = OIIO::ImageInput::open(file("a.exr").string());
    ASSERT_TRUE(input);
    const OIIO::ImageSpec spec = input->spec();
    for (int c = 0; c < spec.nchannels; ++c) {
        const std::string& name = spec.channelnames[static_cast<std::size_t>(c)];
        EXPECT_EQ(spec.channelformat(c),
                  isColourChannelName(name) ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT)
            << name;
    }
    const Picture back = readExr(file("a.exr"));
    EXPECT_EQ(back.find("R")->values[0], 65504.0f);
    EXPECT_EQ(back.find("Z")->values[0], 1e10f);
    EXPECT_EQ(back.find("N.X")->values, picture.find("N.X")->values);
}

TEST_F(Exr, TwoRunsGiveTheSameBytes) {
    writeExr(file("a.exr"), fullPicture());
    writeExr(file("b.exr"), fullPicture());
    EXPECT_EQ(readBytes(file("a.exr")), readBytes(file("b.exr")));
    EXPECT_GT(readBytes(file("a.exr")).size(), 1000u);
    EXPECT_EQ(std::get<std::string>(readExr(file("a.exr")).attributes.at("DateTime")),
              "2000:01:01 00:00:00");
}

TEST_F(Exr, BadFilesAreRefusedByName) {
    EXPECT_TRUE(refusesWith(refusal([&] { readExr(file("none.exr")); }), 4,
                            {"none.exr", "does not exist"}));
    writeBytes(file("text.exr"), "this is no picture");
    EXPECT_TRUE(refusesWith(refusal([&] { readExr(file("text.exr")); }), 3, {"text.exr"}));
    EXPECT_TRUE(refusesWith(refusal([&] { readExr(folder()); }), 4, {"is not a file"}));
    writeExr(file("a.exr"), fullPicture());
    const std::string bytes = readBytes(file("a.exr"));
    for (const double fraction : {0.2, 0.5, 0.9, 0.999}) {
        const auto size = static_cast<std::size_t>(fraction * static_cast<double>(bytes.size()));
        writeBytes(file("cut.exr"), bytes.substr(0, size));
        EXPECT_TRUE(refusesWith(refusal([&] { readExr(file("cut.exr")); }), 3, {"cut.exr"}))
            << fraction;
    }
    writeDisplayPicture(file("p.png"), {1, 1, 3, {0, 0, 0}});
    std::filesystem::rename(file("p.png"), file("p.exr"));
    EXPECT_TRUE(refusesWith(refusal([&] { readExr(file("p.exr")); }), 3, {"p.exr", "OpenEXR"}));
}

TEST_F(Exr, AWrongPictureIsAnInternalError) {
    Picture picture = fullPicture();
    picture.channels[1].name = "R";
    EXPECT_TRUE(refusesWith(refusal([&] { writeExr(file("a.exr"), picture); }), 1, {"named R"}));
    picture = fullPicture();
    picture.channels[2].values.pop_back();
    EXPECT_TRUE(refusesWith(refusal([&] { writeExr(file("a.exr"), picture); }), 1, {"channel B"}));
    EXPECT_EQ(listing(), "");
}

TEST(ChannelNames, TellColourFromData) {
    for (const char* name : {"R", "A", "direct.G", "albedo.B", "denoiseAlbedo.R"}) {
        EXPECT_TRUE(isColourChannelName(name)) << name;
    }
    for (const char* name : {"Z", "N.X", "P.Z", "samples.X", "AR", ""}) {
        EXPECT_FALSE(isColourChannelName(name)) << name;
    }
}

}  // namespace
}  // namespace pm::host::test
