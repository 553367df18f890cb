// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Ctrl-C and termination: what is finished is kept under NAME.partial.EXT, nothing else is left.
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <initializer_list>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "host_shim/pictures/picture_io.h"
#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

class Interrupt : public HostProcess {
  protected:
    // Renders something endless and sends signals once it has begun.
    Outcome interrupted(const std::vector<int>& signals) const {
        return run({"box.obj", "--size", "64x64", "--passes", "1000000", "--photons", "1000", "-o",
                    "a.exr", "-o", "a.png", "--stats", "s.json", "--progress", "none"},
                   [&](pid_t child) {
                       waitForRender();
                       for (const int signal : signals) {
                           kill(child, signal);
                           // Long enough not to be one for the system already.
                           std::this_thread::sleep_for(std::chrono::milliseconds(2));
                       }
                   });
    }

    void waitForRender() const {
        for (int i = 0; i < 600; ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
            if (readText(path(".err")).find("pass 2 of") != std::string::npos) return;
        }
    }

    void expectPartial(const Outcome& outcome, int code, const std::string& reason) const {
        EXPECT_EQ(outcome.exitCode, code) << outcome.err;
        EXPECT_NE(outcome.err.find("pm_host: " + reason), std::string::npos) << outcome.err;
        EXPECT_EQ(leftFiles(),
                  (std::vector<std::string>{"a.partial.exr", "a.partial.png", "s.json"}));
        const Picture picture = readExr(path("a.partial.exr"));
        EXPECT_EQ(std::get<std::int32_t>(picture.attributes.at("pm:complete")), 0);
        const auto json = nlohmann::json::parse(readText(path("s.json")));
        EXPECT_EQ(json.at("stopReason"), reason);
        EXPECT_EQ(json.at("exitCode"), code);
    }

    // Terminates runs with --stats s.json after these shares of the time that an undisturbed one
    // takes; check gets those that the signal ended. Returns how many that were. Beside other
    // programs the undisturbed run may be slower than the others, or faster: where fewer than
    // `wanted` were ended all is done again, up to three times.
    int terminateAt(int wanted, std::initializer_list<double> shares,
                    const std::vector<std::string>& arguments,
                    const std::function<void(const Outcome&)>& check) const {
        int terminated = terminateOnceAt(shares, arguments, check);
        for (int again = 0; again < 3 && terminated < wanted; ++again)
            terminated = terminateOnceAt(shares, arguments, check);
        return terminated;
    }

    int terminateOnceAt(std::initializer_list<double> shares,
                        const std::vector<std::string>& arguments,
                        const std::function<void(const Outcome&)>& check) const {
        const auto start = std::chrono::steady_clock::now();
        EXPECT_EQ(runProgram(arguments).exitCode, 0);
        const auto whole = std::chrono::steady_clock::now() - start;
        int terminated = 0;
        for (const double share : shares) {
            fs::remove(path("s.json"));
            fs::remove_all(path(".cache"));
            std::chrono::steady_clock::time_point told;
            const Outcome outcome = runProgram(arguments, [&](pid_t child) {
                std::this_thread::sleep_for(share * whole);
                told = std::chrono::steady_clock::now();
                kill(child, SIGTERM);
            });
            const std::chrono::duration<double> took = std::chrono::steady_clock::now() - told;
            // Before it has its handlers the signal ends it, and after its end nothing does.
            if (outcome.exitCode != 143) continue;
            ++terminated;
            std::cout << "at " << share << " of " << std::chrono::duration<double>(whole).count()
                      << " s: ended " << took.count() << " s after the signal" << std::endl;
            EXPECT_EQ(nlohmann::json::parse(readText(path("s.json"))).at("stopReason"),
                      "terminated");
            check(outcome);
        }
        return terminated;
    }
};

TEST_F(Interrupt, controlC) {
    expectPartial(interrupted({SIGINT}), 130, "interrupted");
}

TEST_F(Interrupt, termination) {
    expectPartial(interrupted({SIGTERM}), 143, "terminated");
}

// Where there is nowhere to keep them.
TEST_F(Interrupt, bakedTexturesAreRemoved) {
    addTexture();
    write("in_the_way", "");
    std::string during;
    const Outcome outcome = run({"box.obj", "--size", "64x64", "--passes", "1000000", "--photons",
                                 "1000", "-o", "a.exr", "--progress", "none"},
                                [&](pid_t child) {
                                    waitForRender();
                                    during = textureFolder();
                                    kill(child, SIGINT);
                                },
                                {{"XDG_CACHE_HOME", path("in_the_way").string()}});
    EXPECT_EQ(outcome.exitCode, 130) << outcome.err;
    EXPECT_NE(during, "");
    EXPECT_EQ(textureFolder(), "");
}

// A signal that comes while a large scene is read or built ends that, too. The moments are shares
// of the time that an undisturbed run takes.
TEST_F(Interrupt, beforeTheRenderBegins) {
    constexpr int kSide = 70;
    std::string text = "mtllib box.mtl\nusemtl light\nv 0 0 9\nv 1 0 9\nv 0 1 9\nf 1 2 3\n";
    text += "usemtl wall\n";
    for (int y = 0; y <= kSide; ++y)
        for (int x = 0; x <= kSide; ++x) text += fmt::format("v {} {} {}\n", x, y, (x * y) % 7);
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            const int corner = 4 + y * (kSide + 1) + x;
            text += fmt::format("f {} {} {} {}\n", corner, corner + 1, corner + kSide + 2,
                                corner + kSide + 1);
        }
    write("sheet.obj", text);
    const std::vector<std::string> arguments{"sheet.obj", "--subdivide", "all", "--explain",
                                             "--stats",   "s.json",      "-o",  "a.exr"};
    const int interrupted =
        terminateAt(2, {0.1, 0.3, 0.5, 0.7, 0.9}, arguments, [&](const Outcome& outcome) {
            EXPECT_NE(outcome.err.find("pm_host: terminated"), std::string::npos) << outcome.err;
            EXPECT_FALSE(fs::exists(path("a.exr")));
        });
    EXPECT_GE(interrupted, 2);
}

// In all that a sidecar of many entries goes through: reading, adding to the scene, handing over.
// PM_ENTRIES=1000000 takes so many of each.
TEST_F(Interrupt, whileALargeSidecarIsTaken) {
    const char* asked = std::getenv("PM_ENTRIES");
    const int count = asked == nullptr ? 15000 : std::atoi(asked);
    const auto list = [count](const std::string& entry) {
        std::string text = "[" + entry;
        for (int i = 1; i < count; ++i) text += ",\n" + entry;
        return text + "]";
    };
    write("box.pm.json",
          "{\"schema\": \"pm-sidecar/1\", \"instances\": " + list(R"({"translate": [0, 0, 1]})") +
              ", \"spheres\": " + list(R"({"radius": 0.01, "material": "wall"})") +
              ", \"lights\": " +
              list(R"({"type": "point", "position": [0, 0, 0], "intensity": 1})") + "}");
    const std::vector<std::string> arguments{"box.obj", "--explain", "--stats", "s.json"};
    const int interrupted =
        terminateAt(3, {0.1, 0.3, 0.5, 0.7}, arguments, [&](const Outcome& outcome) {
            EXPECT_NE(outcome.err.find("pm_host: terminated"), std::string::npos) << outcome.err;
        });
    EXPECT_GE(interrupted, 3);
}

// The libraries that read and bake a large picture can't be told to stop; nobody waits for them.
// PM_TEXELS=8192 takes one of so many columns.
TEST_F(Interrupt, whileATextureIsBaked) {
    const char* columns = std::getenv("PM_TEXELS");
    const int width = columns == nullptr ? 1024 : std::atoi(columns), height = width / 2;
    std::string texels = fmt::format("P6\n{} {}\n255\n", width, height);
    for (int i = 0; i < width * height * 3; ++i)
        texels.push_back(static_cast<char>(i * 31 + i / 977));
    write("wall.ppm", texels);
    write("box.mtl", "newmtl light\nKd 0 0 0\nKe 5 5 5\nnewmtl wall\nmap_Kd wall.ppm\n");
    const std::vector<std::string> arguments{"box.obj", "--explain", "--stats", "s.json"};
    const int interrupted = terminateAt(1, {0.4, 0.6, 0.8, 0.9}, arguments, [&](const Outcome&) {
        EXPECT_EQ(textureFolder(), "");
        EXPECT_TRUE(halfMadeTextures().empty());
    });
    EXPECT_GE(interrupted, 1);
}

// timeout(1) sends its signal to the process and to its group.
TEST_F(Interrupt, twoSignalsInOneMomentAreOne) {
    expectPartial(interrupted({SIGTERM, SIGTERM}), 143, "terminated");
}

// Writing so many files takes longer than the second signal.
TEST_F(Interrupt, aSecondSignalEndsAtOnce) {
    std::vector<std::string> arguments{"box.obj", "--size",     "512x512", "--passes",
                                       "1000000", "--aa",       "1",       "--photons",
                                       "1000",    "--progress", "none"};
    for (int i = 0; i < 100; ++i)
        arguments.insert(arguments.end(), {"-o", fmt::format("{}.exr", i)});
    const Outcome outcome = run(arguments, [&](pid_t child) {
        waitForRender();
        kill(child, SIGINT);
        std::this_thread::sleep_for(std::chrono::milliseconds(400));
        kill(child, SIGTERM);
    });
    EXPECT_EQ(outcome.exitCode, 143) << outcome.err;
    EXPECT_FALSE(fs::exists(path("99.partial.exr")));
    EXPECT_FALSE(fs::exists(path("0.exr")));
}

}  // namespace
}  // namespace pm::host::test
