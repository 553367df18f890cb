// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Ctrl-C and termination: what is finished is kept under NAME.partial.EXT, nothing else is left.
#include "host_shim/pictures/picture_io.h"
#include "tests/robust/host_process.h"

#include <nlohmann/json.hpp>

#include <chrono>
#include <thread>

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
                       for (const int signal : signals) kill(child, signal);
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
};

TEST_F(Interrupt, controlC) {
    expectPartial(interrupted({SIGINT}), 130, "interrupted");
}

TEST_F(Interrupt, termination) {
    expectPartial(interrupted({SIGTERM}), 143, "terminated");
}

TEST_F(Interrupt, bakedTexturesAreRemoved) {
    addTexture();
    std::string during;
    const Outcome outcome = run({"box.obj", "--size", "64x64", "--passes", "1000000", "--photons",
                                 "1000", "-o", "a.exr", "--progress", "none"},
                                [&](pid_t child) {
                                    waitForRender();
                                    during = textureFolder();
                                    kill(child, SIGINT);
                                });
    EXPECT_EQ(outcome.exitCode, 130) << outcome.err;
    EXPECT_NE(during, "");
    EXPECT_EQ(textureFolder(), "");
}

TEST_F(Interrupt, aSecondSignalEndsAtOnce) {
    const Outcome outcome = interrupted({SIGINT, SIGTERM});
    EXPECT_TRUE(outcome.exitCode == 143 || outcome.exitCode == 130) << outcome.exitCode;
    EXPECT_FALSE(fs::exists(path("a.exr")));
}

}  // namespace
}  // namespace pm::host::test
