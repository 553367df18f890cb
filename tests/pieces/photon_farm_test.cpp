// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Photons once, then parts and other views of the scene: the command lines of docs/farm.md.
#include <nlohmann/json.hpp>

#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

class PhotonFarm : public HostProcess {
  protected:
    std::vector<std::string> command(const std::vector<std::string>& more) const {
        std::vector<std::string> arguments{"box.obj",   "--size", "40x28",         "--aa",
                                           "2",         "-q",     "--plan",        "everything",
                                           "--photons", "1000",   "--bucket-size", "8"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return arguments;
    }
    void makePhotons(const std::string& passes) const {
        const Outcome outcome = run(command({"--photons-only", "--photon-map", "b.pmphotons",
                                             "--passes", passes, "--stats", "p.json"}));
        ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
        ASSERT_EQ(outcome.out, "");
    }
};

TEST_F(PhotonFarm, PhotonsOnceThenParts) {
    makePhotons("3");
    const auto json = nlohmann::json::parse(readText(path("p.json")));
    EXPECT_EQ(json.at("stopReason"), "passes done");
    EXPECT_EQ(json.at("outputs"), nlohmann::json::array({"b.pmphotons"}));
    EXPECT_EQ(json.at("photonMap").at("use"), "written");
    fs::remove(path("p.json"));
    EXPECT_EQ(leftFiles(), std::vector<std::string>{"b.pmphotons"});
    for (const char* part : {"1", "2"}) {
        const Outcome outcome =
            run(command({"--photon-map", "b.pmphotons", "--passes", "2", "--buckets",
                         std::string(part) + "/2", "-o", std::string("p") + part + ".pmpart"}));
        ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    }
    ASSERT_EQ(run({"merge", "p1.pmpart", "p2.pmpart", "-o", "m.exr", "-q"}).exitCode, 0);
    ASSERT_EQ(run(command({"--passes", "2", "-o", "a.exr"})).exitCode, 0);
    EXPECT_TRUE(readText(path("m.exr")) == readText(path("a.exr")));
}

TEST_F(PhotonFarm, OtherViewsOfTheScene) {
    makePhotons("2");
    const std::vector<std::string> view{"--passes", "2",        "--eye",  "3,2,4",
                                        "--fov",    "60",       "--crop", "5,5,30,20",
                                        "--filter", "gaussian", "-o"};
    std::vector<std::string> traced = view, read = view;
    traced.push_back("a.exr");
    read.insert(read.end(), {"b.exr", "--photon-map", "b.pmphotons", "--size", "40x28"});
    ASSERT_EQ(run(command(traced)).exitCode, 0);
    ASSERT_EQ(run(command(read)).exitCode, 0);
    EXPECT_TRUE(readText(path("a.exr")) == readText(path("b.exr")));
    write("box.mtl", "newmtl light\nKd 0 0 0\nKe 5 5 5\nnewmtl wall\nKd 0.4 0.5 0.5\n");
    const Outcome refused = run(command({"--passes", "2", "--photon-map", "b.pmphotons"}));
    EXPECT_EQ(refused.exitCode, 3);
    EXPECT_NE(refused.err.find("differs in: materials"), std::string::npos) << refused.err;
    EXPECT_EQ(refused.errorLines(), 1u) << refused.err;
}

// The photons know what they were aimed at.
TEST_F(PhotonFarm, OnAHugeGround) {
    write("ground.obj",
          "mtllib box.mtl\nv -900 0 900\nv 900 0 900\nv 900 0 -900\nv -900 0 -900\n"
          "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 2 0\nv 1 2 0\nv 1 2 1\nv 0 2 1\n"
          "usemtl wall\nf 1 2 3 4\nf 5 6 7 8\nusemtl light\nf 9 10 11 12\n");
    const auto render = [&](std::vector<std::string> more) {
        more.insert(more.begin(),
                    {"ground.obj", "--size", "32x24", "--aa", "2", "-q", "--photons", "1000",
                     "--passes", "2", "--eye", "0.5,1,4", "--look-at", "0.5,0.5,0"});
        const Outcome outcome = run(more);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    };
    render({"--photons-only", "--photon-map", "g.pmphotons"});
    render({"--photon-map", "g.pmphotons", "-o", "read.exr", "--stats", "s.json"});
    render({"-o", "traced.exr"});
    EXPECT_TRUE(readText(path("read.exr")) == readText(path("traced.exr")));
    const auto json = nlohmann::json::parse(readText(path("s.json")));
    EXPECT_EQ(json.at("plan").at("photonsInFocus"), true);
}

TEST_F(PhotonFarm, CommandLinesThatMakeNoSense) {
    const auto refused = [&](std::vector<std::string> more, const std::string& text) {
        more.insert(more.end(), {"--photons-only", "--photon-map", "b.pmphotons"});
        const Outcome outcome = run(command(more));
        EXPECT_EQ(outcome.exitCode, 2) << outcome.err;
        EXPECT_NE(outcome.err.find(text), std::string::npos) << outcome.err;
    };
    refused({"-o", "a.exr"}, "-o");
    refused({"--buckets", "1/2"}, "--buckets");
    refused({"--checkpoint", "c"}, "--checkpoint");
    refused({"--time-limit", "2"}, "--time-limit");
    refused({"--error-target", "2"}, "--error-target");
    refused({"--report", "r.html"}, "--report");
    refused({"--aov", "N"}, "--aov");
    refused({"--integrator", "path"}, "path");
    EXPECT_EQ(run(command({"--photon-map", "box.mtl", "--photons-only"})).exitCode, 2);
    EXPECT_EQ(run(command({"--photon-map", "x.exr", "-o", "x.exr"})).exitCode, 2);
    EXPECT_EQ(run(command({"--photon-map", "no/b", "--photons-only"})).exitCode, 4);
    EXPECT_TRUE(leftFiles().empty());
}

}  // namespace
}  // namespace pm::host::test
