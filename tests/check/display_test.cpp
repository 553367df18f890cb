// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Display pictures as references of pm_host, and how two of them differ.
#include <cmath>

#include "host_shim/pictures/display_compare.h"
#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

DisplayPicture grey(float value) {
    return {64, 48, 3, std::vector<float>(64 * 48 * 3, value)};
}

TEST(CompareDisplay, CountsCodes) {
    const DisplayPicture a = grey(100.0f / 255);
    DisplayPicture b = a;
    b.values[(64 * 10 + 20) * 3 + 1] = 104.0f / 255;
    const DisplayDifference difference = compareDisplay(a, b);
    EXPECT_NEAR(difference.most, 4, 1e-4);
    EXPECT_EQ(difference.x, 20);
    EXPECT_EQ(difference.y, 10);
    EXPECT_EQ(difference.channel, 1);
    EXPECT_NEAR(difference.mean, 4.0 / (64 * 48 * 3), 1e-6);
    EXPECT_NEAR(difference.rms, 4 / std::sqrt(64 * 48 * 3.0), 1e-5);
    EXPECT_EQ(compareDisplay(a, a).visiblePixels, 0);
    EXPECT_THROW(compareDisplay(a, DisplayPicture{64, 47, 3, std::vector<float>(64 * 47 * 3)}),
                 HostError);
}

// OpenImageIO 2.4 looks at hue and saturation alone.
TEST(CompareDisplay, SeesWhatAnEyeSees) {
    const DisplayPicture a = grey(0.5f);
    DisplayPicture faint = a, plain = a;
    for (std::size_t i = 0; i < 16 * 64 * 3; i += 3) {
        faint.values[i] = 0.5f + 0.4f / 255;
        plain.values[i] = 0.8f;
    }
    EXPECT_EQ(compareDisplay(a, faint).visiblePixels, 0);
    EXPECT_EQ(compareDisplay(a, plain).visiblePixels, 16 * 64);
}

TEST(ReadDisplayPicture, ReadsWhatIsWritten) {
    const fs::path file = fs::path(::testing::TempDir()) / "pm_display_test.png";
    DisplayPicture picture = grey(0.25f);
    picture.values[7] = 1.0f;
    writeDisplayPicture(file, picture);
    const DisplayPicture read = readDisplayPicture(file);
    EXPECT_EQ(read.values, asCodes(picture).values);
    fs::remove(file);
    EXPECT_THROW(readDisplayPicture(file), HostError);
}

class DisplayReference : public HostProcess {};

TEST_F(DisplayReference, IsComparedInItsSpace) {
    ASSERT_EQ(render({"-o", "box.png", "--exposure", "0"}).exitCode, 0);
    const Outcome same = render({"-o", "again.exr", "--reference", "box.png"});
    EXPECT_EQ(same.exitCode, 0) << same.err;
    EXPECT_EQ(same.out,
              "code difference rms 0, at most 0 of 255 (R at 0,0), 0 pixels visibly "
              "different\n");
    const Outcome other = render(
        {"-o", "again.exr", "--reference", "box.png", "--exposure", "1", "--error-limit", "1"});
    EXPECT_EQ(other.exitCode, 6) << other.err;
    EXPECT_NE(other.err.find("above the limit 1"), std::string::npos) << other.err;
    EXPECT_EQ(render({"-o", "again.exr", "--reference", "box.png", "--size", "8x8"}).exitCode, 3);
    EXPECT_EQ(render({"-o", "again.exr", "--reference", "none.png"}).exitCode, 4);
}

}  // namespace
}  // namespace pm::host::test
