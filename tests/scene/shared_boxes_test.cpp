// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Boxes that other people made. They lie outside the repository; without them the tests are
// skipped.
#include <fmt/format.h>

#include "host_shim/pictures/picture_io.h"
#include "tests/colour/scratch.h"
#include "tests/scene/host_test.h"
#include "tests/scene/picture_measures.h"

namespace pm::host::test {
namespace {

const fs::path kBoxes = fs::path(PM_SHARED_DATA) / "obj-gi";

struct Box {
    const char* file;
    Arguments camera;
    bool dark{};  // the automatic camera sees a closed room from outside
};
void PrintTo(const Box& box, std::ostream* out) {
    *out << box.file;
}

std::vector<Box> boxes() {
    const Arguments front{"--eye", "0,1,3.8", "--look-at", "0,1,0", "--fov", "35"};
    return {
        {"mcguire-cornell/CornellBox-Empty-CO.obj", front},
        {"mcguire-cornell/CornellBox-Empty-White.obj", front},
        {"mcguire-cornell/CornellBox-Glossy-Floor.obj", front},
        {"mcguire-cornell/CornellBox-Original.obj", front},
        {"mcguire-cornell/CornellBox-Sphere.obj", front},
        {"tungsten/tungsten-cornell-box.obj", front},
        {"embree/cornell_box.obj",
         {"--eye", "278,273,-800", "--look-at", "278,273,0", "--fov", "39"}},
        {"embree/spheres.obj", {"--eye", "0,3,8", "--look-at", "0,0,0"}},
        {"minhlucky9/testChamberPH.obj", {"--eye", "3,2,5", "--look-at", "0,0,0", "--fov", "60"}},
        {"mcguire-holodeck/holodeck.obj",
         {"--eye", "200,100,0", "--look-at", "0,100,0", "--fov", "60"},
         true},
    };
}

class SharedBoxes : public HostTest, public ::testing::WithParamInterface<Box> {
  protected:
    void SetUp() override {
        if (!fs::exists(kBoxes)) GTEST_SKIP() << "no optional data at " << kBoxes.string();
        HostTest::SetUp();
    }

    void check(const Picture& picture, bool dark) const {
        ASSERT_TRUE(allFinite(picture));
        EXPECT_TRUE(dark || isLit(picture, 0.5));
        const Means means = meansOf(picture);
        std::cout << fmt::format("mean {:.4g} {:.4g} {:.4g}\n", means[0], means[1], means[2]);
        EXPECT_LT(std::max({means[0], means[1], means[2]}), 1e4);
        EXPECT_TRUE(readBytes(path("box.png")).starts_with("\x89PNG"));
    }
    std::string file() const { return (kBoxes / GetParam().file).string(); }
};

TEST_P(SharedBoxes, ByTheAutomaticCamera) {
    const Picture picture = renderExr("box", {file(), "--size", "96x72", "--passes", "1", "--aov",
                                              "albedo,N,Z", "-o", "box.png"});
    check(picture, GetParam().dark);
}

TEST_P(SharedBoxes, ByAGivenCamera) {
    const Arguments small{file(), "--size", "96x72", "--passes", "1", "-o", "box.png"};
    check(renderExr("box", small + GetParam().camera), false);
}

std::string caseName(const ::testing::TestParamInfo<Box>& box) {
    std::string name = fs::path(box.param.file).stem().string();
    std::erase_if(name, [](char c) { return c == '-' || c == '_'; });
    return name + std::to_string(box.index);
}
INSTANTIATE_TEST_SUITE_P(All, SharedBoxes, ::testing::ValuesIn(boxes()), caseName);

class OneSharedBox : public SharedBoxes {};

// With nothing but outputs named, so 640 x 480 pixels and four passes.
TEST_P(OneSharedBox, WithNoOption) {
    const Outcome outcome = run({file(), "-o", "box.exr", "-o", "box.png"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err.find("warning"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("wrote box.png, estimated relMSE"), std::string::npos);
    const Picture picture = readExr(path("box.exr"));
    EXPECT_EQ(picture.dataWindow, (PixelRect{0, 0, 640, 480}));
    check(picture, false);
}
INSTANTIATE_TEST_SUITE_P(Original, OneSharedBox, ::testing::Values(boxes()[3]), caseName);

// What is named above is all there is.
TEST(SharedBoxFiles, AreAllNamed) {
    if (!fs::exists(kBoxes)) GTEST_SKIP() << "no optional data at " << kBoxes.string();
    std::size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(kBoxes)) {
        count += entry.path().extension() == ".obj" ? 1u : 0u;
    }
    EXPECT_EQ(count, boxes().size());
}

}  // namespace
}  // namespace pm::host::test
