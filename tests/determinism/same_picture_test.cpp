// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// A picture is a function of scene, settings and seed: what else may differ must not change a bit.
#include <fmt/format.h>
#include <langinfo.h>
#include <locale.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "host_shim/pictures/picture_io.h"
#include "tests/colour/scratch.h"
#include "tests/determinism/mixed_scene.h"
#include "tests/scene/host_test.h"
#include "tests/scene/picture_measures.h"

namespace pm::host::test {
namespace {

class SamePicture : public HostTest {
  protected:
    void SetUp() override {
        HostTest::SetUp();
        writeMixedScene(m_folder);
    }

    // The file's bytes; nothing of how it was made (threads, buckets, time) is written into it.
    std::string bytes(const std::string& name, const Arguments& more,
                      const std::vector<std::pair<std::string, std::string>>& variables = {}) {
        renderExr(name, m_settings + more, variables);
        return readBytes(path(name + ".exr"));
    }

    void expectSame(const std::vector<Arguments>& ways) {
        const std::string first = bytes("first", ways[0]);
        ASSERT_TRUE(allFinite(readExr(path("first.exr"))));
        ASSERT_TRUE(isLit(readExr(path("first.exr")), 0.99));
        for (std::size_t i = 1; i < ways.size(); ++i) {
            // Not EXPECT_EQ, which would print the bytes.
            EXPECT_TRUE(first == bytes(fmt::format("way{}", i), ways[i]))
                << "differs with " << ways[i][0] << " " << ways[i][1];
        }
    }

    Arguments m_settings{"mixed.obj", "--size", "96x72",    "--eye", "0,1,3.6",
                         "--look-at", "0,1,0",  "--passes", "2",     "--photons",
                         "20000",     "--aa",   "2:3",      "--aov", "albedo,N,Z,stderr,samples"};
};

TEST_F(SamePicture, SceneHasEveryWayOfLight) {
    const Picture picture = renderExr("parts", m_settings);
    for (const char* part : {"direct.", "indirect.", "caustic.", "emission."}) {
        EXPECT_GT(meansOf(picture, part)[1], 1e-4) << part;
    }
    const auto [least, most] = std::ranges::minmax(picture.find("samples.X")->values);
    EXPECT_LT(least, most) << "all pixels have as many samples";
}

TEST_F(SamePicture, ForAnyThreads) {
    expectSame({{"--threads", "1"}, {"--threads", "2"}, {"--threads", "5"}});
}

TEST_F(SamePicture, ForAnyBucketOrder) {
    std::vector<Arguments> ways;
    for (const char* order :
         {"hilbert", "row", "column", "diagonal", "spiral", "random", "correlated"})
        ways.push_back({"--bucket-order", order});
    expectSame(ways);
}

TEST_F(SamePicture, ForAnyBucketSize) {
    expectSame({{"--bucket-size", "16"},
                {"--bucket-size", "8"},
                {"--bucket-size", "48"},
                {"--bucket-size", "256"},
                {"--bucket-size", "auto"}});
}

TEST_F(SamePicture, ForThePathIntegrator) {
    m_settings = m_settings + Arguments{"--integrator", "path"};
    expectSame({{"--threads", "1", "--bucket-size", "16", "--bucket-order", "row"},
                {"--threads", "5", "--bucket-size", "48", "--bucket-order", "hilbert"}});
}

TEST_F(SamePicture, ForTwoRuns) {
    expectSame({{"--display", "sRGB", "-o", "a.png"}, {"--display", "sRGB", "-o", "b.png"}});
    EXPECT_TRUE(readBytes(path("a.png")) == readBytes(path("b.png")));
    EXPECT_GT(readBytes(path("a.png")).size(), 1000u);
}

TEST_F(SamePicture, NotForAnotherSeedOrPassCount) {
    const std::string first = bytes("first", {"--seed", "1"});
    EXPECT_FALSE(first == bytes("seed", {"--seed", "2"}));
    EXPECT_FALSE(first == bytes("passes", {"--passes", "3"}));
    const Picture one = readExr(path("first.exr")), two = readExr(path("seed.exr"));
    EXPECT_NE(one.find("indirect.R")->values, two.find("indirect.R")->values);
    EXPECT_NE(one.find("caustic.R")->values, two.find("caustic.R")->values);
}

// Makes the locale with localedef where it is not installed; the folder is what LOCPATH wants.
bool hasCommaLocale(const fs::path& folder) {
    const std::string target = (folder / "de_DE.UTF-8").string();
    const std::string command = "localedef -i de_DE -f UTF-8 '" + target + "' >/dev/null 2>&1";
    setenv("LOCPATH", folder.c_str(), 1);
    if (std::system(command.c_str()) == -1 || !fs::exists(target)) unsetenv("LOCPATH");
    const locale_t locale = newlocale(LC_ALL_MASK, "de_DE.UTF-8", nullptr);
    if (locale == nullptr) return false;
    const bool comma = std::strcmp(nl_langinfo_l(RADIXCHAR, locale), ",") == 0;
    freelocale(locale);
    return comma;
}

TEST_F(SamePicture, UnderACommaLocale) {
    const std::string plain = bytes("plain", {"--fov", "40.5"});
    if (!hasCommaLocale(m_folder)) GTEST_SKIP() << "no locale with a comma, and none can be made";
    EXPECT_TRUE(plain == bytes("comma", {"--fov", "40.5"},
                               {{"LC_ALL", "de_DE.UTF-8"}, {"LANG", "de_DE.UTF-8"}}));
    unsetenv("LOCPATH");
}

// Index of pixel x,y of the display window in a picture's channels.
std::size_t indexAt(const Picture& picture, std::int32_t x, std::int32_t y) {
    const PixelRect& window = picture.dataWindow;
    return static_cast<std::size_t>(y - window.y0) * static_cast<std::size_t>(window.width()) +
           static_cast<std::size_t>(x - window.x0);
}

// All channels hold the same bits over what both windows show.
void expectSameWhereBoth(const Picture& a, const Picture& b, std::int64_t pixels) {
    const PixelRect &p = a.dataWindow, &q = b.dataWindow;
    const PixelRect both{std::max(p.x0, q.x0), std::max(p.y0, q.y0), std::min(p.x1, q.x1),
                         std::min(p.y1, q.y1)};
    ASSERT_EQ(both.area(), pixels);
    ASSERT_EQ(a.channels.size(), b.channels.size());
    for (const Channel& channel : a.channels) {
        const Channel* other = b.find(channel.name);
        ASSERT_NE(other, nullptr) << channel.name;
        int different = 0;
        for (std::int32_t y = both.y0; y < both.y1; ++y) {
            for (std::int32_t x = both.x0; x < both.x1; ++x) {
                different += std::memcmp(&channel.values[indexAt(a, x, y)],
                                         &other->values[indexAt(b, x, y)], sizeof(float)) != 0;
            }
        }
        EXPECT_EQ(different, 0) << channel.name;
    }
}

TEST_F(SamePicture, ForACrop) {
    const Picture whole = renderExr("whole", m_settings);
    const PixelRect crop{13, 7, 61, 50};  // on no boundary of a bucket or of 8 x 8 pixels
    const Picture part = renderExr("part", m_settings + Arguments{"--crop", cropText(crop)});
    EXPECT_EQ(part.dataWindow, crop);
    EXPECT_EQ(part.width, 96);
    expectSameWhereBoth(whole, part, crop.area());
}

TEST_F(SamePicture, ForOverscan) {
    const Picture whole = renderExr("whole", m_settings);
    const PixelRect crop{-11, -5, 103, 75};
    const Picture over = renderExr("over", m_settings + Arguments{"--crop", cropText(crop)});
    EXPECT_EQ(over.dataWindow, crop);
    expectSameWhereBoth(whole, over, 96 * 72);
    const PixelRect corner{-9, -3, 20, 10};
    const Picture part = renderExr("corner", m_settings + Arguments{"--crop", cropText(corner)});
    expectSameWhereBoth(over, part, corner.area());
}

}  // namespace
}  // namespace pm::host::test
