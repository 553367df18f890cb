// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Pictures that are hard to read, and the folder of prepared ones, as a user sees them.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

class Textures : public HostProcess {
  protected:
    void useForWalls(const std::string& picture) const {
        write("box.mtl", "newmtl light\nKd 0 0 0\nKe 5 5 5\nnewmtl wall\nmap_Kd " + picture + "\n");
    }
    Outcome look(const std::vector<std::string>& more) const {
        std::vector<std::string> arguments{"box.obj", "--explain"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run(arguments);
    }
};

TEST_F(Textures, ASecondRunOpensNoOriginal) {
    addTexture();
    const std::string first = look({"-v"}).err, second = look({"-v"}).err;
    EXPECT_NE(first.find("textures: 0 found prepared, 1 made, 1 originals opened"),
              std::string::npos)
        << first;
    EXPECT_NE(second.find("textures: 1 found prepared, 0 made, 0 originals opened"),
              std::string::npos)
        << second;
}

TEST_F(Textures, TheCacheIsListedCheckedAndCleared) {
    addTexture();
    ASSERT_EQ(look({"--texture-cache", "made here"}).exitCode, 0);
    const Outcome list = run({"cache", "--list", "--texture-cache", "made here"});
    EXPECT_EQ(list.exitCode, 0) << list.err;
    EXPECT_NE(list.out.find("wall.png"), std::string::npos) << list.out;
    EXPECT_NE(list.out.find("1 textures"), std::string::npos) << list.out;
    for (const auto& entry : fs::directory_iterator(path("made here") / "textures"))
        if (entry.path().extension() == ".tx")
            std::ofstream(entry.path(), std::ios::binary) << "damage";
    const Outcome verify = run({"cache", "--verify", "--texture-cache", "made here"});
    EXPECT_EQ(verify.exitCode, 3);
    EXPECT_NE(verify.out.find("damaged"), std::string::npos) << verify.out;
    ASSERT_EQ(look({"--texture-cache", "made here"}).exitCode, 0);
    const Outcome clear = run({"cache", "--clear", "--texture-cache", "made here"});
    EXPECT_NE(clear.out.find("1 textures removed"), std::string::npos) << clear.out;
    EXPECT_EQ(run({"cache"}).exitCode, 2);
    EXPECT_EQ(run({"cache", "--list", "--texture-cache", "nowhere"}).exitCode, 4);
}

// All texels of 4096 x 2048, or an eighth of the limit.
TEST_F(Textures, TexelsAreInTheMemoryPlan) {
    const auto output = OIIO::ImageOutput::create("png");
    output->open(path("large.png").string(), {4096, 2048, 3, OIIO::TypeDesc::UINT8});
    output->write_image(OIIO::TypeDesc::UINT8,
                        std::vector<std::uint8_t>(std::size_t{4096} * 2048 * 3, 200).data());
    output->close();
    useForWalls("large.png");
    const std::string roomy = look({"--memory-limit", "8"}).out;
    EXPECT_NE(roomy.find(", textures 0.12)"), std::string::npos) << roomy;
    // All that is left of it, and no more.
    const std::string tight = look({"--memory-limit", "0.4"}).out;
    EXPECT_NE(tight.find(", textures 0.0"), std::string::npos) << tight;
    EXPECT_NE(tight.find("memory: 0.40 GiB"), std::string::npos) << tight;
    ASSERT_EQ(run({"box.obj", "--size", "16x12", "--passes", "1", "--aa", "1", "--photons", "500",
                   "-o", "a.exr"})
                  .exitCode,
              0);
    EXPECT_EQ(run({"box.obj", "--size", "16x12", "--passes", "1", "--aa", "1", "--photons", "500",
                   "--memory-limit", "0.4", "-o", "b.exr"})
                  .exitCode,
              0);
    EXPECT_EQ(readExr(path("a.exr")).find("R")->values, readExr(path("b.exr")).find("R")->values);
}

TEST_F(Textures, TemporaryFoldersAreWhereTmpdirSays) {
    addTexture();
    write("in_the_way", "");
    fs::create_directory(path("own"));
    const auto look = [&](const std::string& place) {
        return run({"box.obj", "--explain", "-v"}, nullptr,
                   {{"XDG_CACHE_HOME", path("in_the_way").string()}, {"TMPDIR", place}});
    };
    for (const char* unusable : {"missing", "in_the_way"}) {
        const Outcome outcome = look(unusable);
        EXPECT_EQ(outcome.exitCode, 4) << outcome.err;
        EXPECT_NE(outcome.err.find(path(unusable).string() + ": no temporary folder can be made"),
                  std::string::npos)
            << outcome.err;
        EXPECT_NE(outcome.err.find("$TMPDIR"), std::string::npos) << outcome.err;
    }
    for (const std::string& place : {path("own").string(), std::string("own")}) {
        const Outcome outcome = look(place);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        EXPECT_TRUE(fs::is_empty(path("own")));
    }
}

TEST_F(Textures, WhereNothingCanBeKept) {
    addTexture();
    write("in_the_way", "");
    const Outcome usual =
        run({"box.obj", "--explain"}, nullptr, {{"XDG_CACHE_HOME", path("in_the_way").string()}});
    EXPECT_EQ(usual.exitCode, 0) << usual.err;
    EXPECT_NE(usual.err.find("textures are made for this run only"), std::string::npos)
        << usual.err;
    EXPECT_EQ(usual.err.find("warning"), std::string::npos) << usual.err;
    EXPECT_EQ(textureFolder(), "");
    const Outcome told = look({"--texture-cache", "in_the_way"});
    EXPECT_EQ(told.exitCode, 0) << told.err;
    EXPECT_NE(told.err.find("in_the_way"), std::string::npos) << told.err;
}

}  // namespace
}  // namespace pm::host::test
