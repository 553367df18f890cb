// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/textures/whole_picture.h"
#include "tests/textures/texture_support.h"

namespace pm::host::test {
namespace {

class BakeRefusal : public TextureTest {
  protected:
    std::string refused(const TextureRequest& request) const {
        return refusal([&] { baked(request); });
    }
    void writeNoise(const std::string& name) const {
        std::vector<float> values;
        std::uint32_t state = 1;
        for (int i = 0; i < 64 * 64 * 3; ++i) {
            state = state * 1664525u + 1013904223u;
            values.push_back(static_cast<float>(state >> 24) / 255.0f);
        }
        writeTexture(file(name), 64, 64, 3, OIIO::TypeDesc::UINT8, values);
    }
};

TEST_F(BakeRefusal, MissingFilesAndFolders) {
    EXPECT_TRUE(refusesWith(refused({file("none.png")}), 4, {"none.png", "does not exist"}));
    EXPECT_TRUE(refusesWith(refused({folder()}), 4, {"is not a file"}));
    writeNoise("a.png");
    EXPECT_TRUE(refusesWith(refused({file("a.png"), TextureKind::kColour, "xyz"}), 3,
                            {"-colorspace", "'xyz'"}));
}

TEST_F(BakeRefusal, BrokenFiles) {
    writeBytes(file("text.png"), "no picture at all");
    EXPECT_TRUE(refusesWith(refused({file("text.png")}), 3, {"text.png"}));
    writeBytes(file("empty.jpg"), "");
    EXPECT_TRUE(refusesWith(refused({file("empty.jpg")}), 3, {"empty.jpg"}));
    std::vector<std::string> names{"a.jpg", "a.tif", "a.exr"};
#ifndef PM_ADDRESS_SANITIZER
    // OpenImageIO 2.4.7's PNG reader leaks its message when libpng jumps out of a cut file.
    names.emplace_back("a.png");
#endif
    for (const std::string& name : names) {
        writeNoise(name);
        const std::string bytes = readBytes(file(name));
        writeBytes(file(name), bytes.substr(0, bytes.size() / 2));
        EXPECT_TRUE(refusesWith(refused({file(name)}), 3, {name})) << name;
    }
    for (const auto& entry : std::filesystem::directory_iterator(cacheFolder() / "textures"))
        ADD_FAILURE() << entry.path();
}

// Every reader of OpenImageIO would be asked to look at it.
TEST_F(BakeRefusal, WhatHasNoMarkOfAPicture) {
    writeBytes(file("zeros.png"), std::string(1 << 20, '\0'));
    EXPECT_TRUE(refusesWith(refused({file("zeros.png")}), 3, {"zeros.png", "no picture"}));
    writeBytes(file("zeros.tga"), std::string(1 << 20, '\0'));
    EXPECT_TRUE(refusesWith(refused({file("zeros.tga")}), 3, {"zeros.tga", "no picture"}));
}

// A header alone can ask for more memory than there is.
TEST_F(BakeRefusal, WhatDoesNotFit) {
    writeNoise("a.bmp");
    const TextureRequest request{file("a.bmp")};
    TexturePreparer small(m_colour, cache(), {1, 1000});
    EXPECT_TRUE(refusesWith(refusal([&] { small.texture(request); }), 5,
                            {"a.bmp", "64 x 64", "1000 are left"}));
    EXPECT_EQ(refused(request), "nothing thrown");
}

// Their readers hold all of a picture, of JPEG as coefficients of 2 bytes.
TEST_F(BakeRefusal, WhatCannotBeReadRowByRowCountsWhole) {
    const auto held = [&](const char* format, const std::filesystem::path& path) {
        const auto input = OIIO::ImageInput::open(path.string());
        return input ? bytesHeldWhole(format, path, input->spec()) : 1;
    };
    const auto write = [&](const char* name, bool isProgressive, const char* sampling) {
        OIIO::ImageSpec spec(100, 60, 3, OIIO::TypeDesc::UINT8);
        spec.attribute("jpeg:progressive", isProgressive ? 1 : 0);
        spec.attribute("jpeg:subsampling", sampling);
        writePicture(file(name), spec, std::vector<float>(100 * 60 * 3, 0.5f));
    };
    write("rows.jpg", false, "4:4:4");
    EXPECT_EQ(held("jpeg", file("rows.jpg")), 0u);
    write("full.jpg", true, "4:4:4");
    EXPECT_EQ(held("jpeg", file("full.jpg")), 13u * 8 * 3 * 128);
    write("half.jpg", true, "4:2:0");
    EXPECT_EQ(held("jpeg", file("half.jpg")), 7u * 4 * 6 * 128);
    // A scan for each component, as the standard allows without being progressive.
    std::string bytes = readBytes(file("rows.jpg"));
    const std::size_t scan = bytes.find("\xff\xda");
    ASSERT_NE(scan, std::string::npos);
    bytes[scan + 4] = 1;
    writeBytes(file("scans.jpg"), bytes);
    EXPECT_EQ(bytesHeldWhole("jpeg", file("scans.jpg"), {}), 13u * 8 * 3 * 128);
    writeNoise("a.png");
    EXPECT_EQ(held("png", file("a.png")), 0u);
    bytes = readBytes(file("a.png"));
    bytes[28] = 1;
    writeBytes(file("adam7.png"), bytes);
    const OIIO::ImageSpec spec(64, 64, 3, OIIO::TypeDesc::UINT8);
    EXPECT_EQ(bytesHeldWhole("png", file("adam7.png"), spec), 64u * 64 * 3);
    EXPECT_EQ(bytesHeldWhole("bmp", file("a.bmp"), spec), 64u * 64 * 3);
}

TEST_F(BakeRefusal, DisplayWindowsBeyondAllMeasure) {
    OIIO::ImageSpec spec(1, 1, 3, OIIO::TypeDesc::FLOAT);
    spec.full_width = 1 << 21;
    writePicture(file("wide.exr"), spec, {1, 1, 1});
    EXPECT_TRUE(refusesWith(refused({file("wide.exr")}), 3, {"wide.exr", "2097152"}));
}

}  // namespace
}  // namespace pm::host::test
