// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// --frames of a scene that is the same for each: rendered once, with the files of each frame.
#include <nlohmann/json.hpp>

#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

constexpr const char* kEqual = "frames are equal, as no #### or %04d in the scene's name";

class EqualFrames : public HostProcess {
  protected:
    // Of the pictures that were written by a render: of copies no error is told.
    static std::size_t picturesIn(const std::string& log) {
        std::size_t count = 0;
        for (std::size_t at = log.find("estimated relMSE"); at != log.npos;
             at = log.find("estimated relMSE", at + 1))
            ++count;
        return count;
    }
    Outcome frames(std::vector<std::string> more) const {
        more.insert(more.begin(), {"box.obj", "--size", "16x16", "--passes", "2", "--photons",
                                   "1000", "--aa", "2", "--frames", "1-5x2"});
        return run(more);
    }
    std::string one(std::vector<std::string> more) const {
        const Outcome outcome = render(more);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        return readText(path("one.exr"));
    }
};

TEST_F(EqualFrames, areRenderedOnceAndHaveTheirFiles) {
    const Outcome outcome =
        frames({"-o", "a.####.exr", "-o", "a.####.png", "-o", "a.####.pmpart", "--stats",
                "s.####.json", "--report", "r.####.html", "--log", "l.####.log", "--bucket-times",
                "b.####.csv", "--aov", "albedo,Z", "--checkpoint", "c.####", "--keep-checkpoint"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_NE(outcome.err.find(std::string("all 3 ") + kEqual), std::string::npos) << outcome.err;
    EXPECT_EQ(picturesIn(outcome.err), 2u) << "of the one render's two pictures\n" << outcome.err;
    // What a render of that frame alone writes.
    ASSERT_EQ(render({"--frame", "5", "-o", "one.exr", "-o", "one.png", "-o", "one.pmpart", "--aov",
                      "albedo,Z", "--checkpoint", "one.ckpt", "--keep-checkpoint"})
                  .exitCode,
              0);
    for (const std::string frame : {"0001", "0003", "0005"}) {
        for (const auto& [name, alone] :
             {std::pair{"a." + frame + ".exr", "one.exr"}, {"a." + frame + ".png", "one.png"}})
            EXPECT_TRUE(readText(path(name)) == readText(path(alone))) << name;
        EXPECT_EQ(fs::file_size(path("a." + frame + ".pmpart")), fs::file_size(path("one.pmpart")));
        EXPECT_EQ(fs::file_size(path("c." + frame)), fs::file_size(path("one.ckpt")));
        const auto json = nlohmann::json::parse(readText(path("s." + frame + ".json")));
        EXPECT_EQ(json.at("outputs"),
                  (std::vector<std::string>{"a." + frame + ".exr", "a." + frame + ".png",
                                            "a." + frame + ".pmpart"}));
        EXPECT_EQ(json.at("commandLine").back(), std::to_string(frame.back() - '0'));
        EXPECT_EQ(json.at("stopReason"), "passes done");
        EXPECT_EQ(json.contains("sameAsFrame"), frame != "0001");
        EXPECT_NE(readText(path("l." + frame + ".log")).find("wrote a." + frame + ".png"),
                  std::string::npos);
        EXPECT_NE(readText(path("r." + frame + ".html")).find("a." + frame + ".exr"),
                  std::string::npos);
        EXPECT_NE(readText(path("b." + frame + ".csv")), "");
    }
    for (const std::string& name : leftFiles()) EXPECT_EQ(name.find(".tmp"), name.npos) << name;
}

TEST_F(EqualFrames, areOfThatSceneAlone) {
    write("s.0001.obj", readText(path("box.obj")));
    write("s.0002.obj", readText(path("box.obj")) + "v 9 9 9\nv 9 8 9\nv 8 9 9\nf 11 12 13\n");
    const Outcome scenes = run({"s.####.obj", "--size", "16x16", "--passes", "2", "--photons",
                                "1000", "--frames", "1-2", "-o", "s.####.exr"});
    ASSERT_EQ(scenes.exitCode, 0) << scenes.err;
    EXPECT_EQ(picturesIn(scenes.err), 2u);
    EXPECT_EQ(scenes.err.find(kEqual), std::string::npos);
    EXPECT_FALSE(readText(path("s.0001.exr")) == readText(path("s.0002.exr")));
    const Outcome seeds = frames({"--seed", "frame", "-o", "a.####.exr"});
    ASSERT_EQ(seeds.exitCode, 0) << seeds.err;
    EXPECT_EQ(picturesIn(seeds.err), 3u);
    EXPECT_EQ(seeds.err.find(kEqual), std::string::npos);
    EXPECT_FALSE(readText(path("a.0001.exr")) == readText(path("a.0003.exr")));
    EXPECT_TRUE(readText(path("a.0003.exr")) ==
                one({"--seed", "3", "--frame", "3", "-o", "one.exr"}));
}

TEST_F(EqualFrames, ofPhotonsAreFilesOfThem) {
    const Outcome outcome = frames({"--photons-only", "--photon-map", "m.####.pmphotons"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    const std::string first = readText(path("m.0001.pmphotons"));
    EXPECT_GT(first.size(), 1000u);
    EXPECT_TRUE(readText(path("m.0005.pmphotons")) == first);
    EXPECT_NE(outcome.err.find("frame 5, 3 of 3"), std::string::npos);
    const Outcome used = render({"--photon-map", "m.0005.pmphotons", "-o", "one.exr"});
    EXPECT_EQ(used.exitCode, 0) << used.err;
    // What is there is somebody's until it was looked into.
    write("n.0003.pmphotons", "mine");
    const Outcome refused = frames({"--photons-only", "--photon-map", "n.####.pmphotons"});
    EXPECT_NE(refused.exitCode, 0) << refused.err;
    EXPECT_EQ(readText(path("n.0003.pmphotons")), "mine");
    EXPECT_TRUE(fs::exists(path("n.0005.pmphotons")));
}

// Results are printed for each, and one that can't be written doesn't end the others.
TEST_F(EqualFrames, areComparedAndFailEach) {
    one({"-o", "one.exr"});
    fs::create_directory(path("a.0003.exr"));
    const Outcome outcome =
        frames({"--reference", "one.exr", "-o", "a.####.exr", "--stats", "s.####.json"});
    EXPECT_EQ(outcome.exitCode, 4) << outcome.err;
    EXPECT_EQ(outcome.out, "relMSE 0\nrelMSE 0\n");
    EXPECT_EQ(picturesIn(outcome.err), 1u);
    EXPECT_TRUE(readText(path("a.0001.exr")) == readText(path("a.0005.exr")));
}

TEST_F(EqualFrames, overwriteNoInput) {
    addTexture();
    const std::string texture = readText(path("wall.png"));
    write("wall.0003.png", texture);
    write("box.mtl", "newmtl light\nKd 0 0 0\nKe 5 5 5\nnewmtl wall\nmap_Kd wall.0003.png\n");
    const Outcome outcome = frames({"-o", "wall.####.png"});
    EXPECT_EQ(outcome.exitCode, 2) << outcome.err;
    EXPECT_NE(outcome.err.find("wall.0003.png"), std::string::npos) << outcome.err;
    EXPECT_TRUE(readText(path("wall.0003.png")) == texture);
    EXPECT_TRUE(readText(path("wall.0005.png")) == readText(path("wall.0001.png")));
}

}  // namespace
}  // namespace pm::host::test
