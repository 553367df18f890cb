// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "host_shim/pictures/picture_io.h"

namespace pm::host::test {

namespace fs = std::filesystem;

inline std::string readText(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return std::move(text).str();
}

// What a run of pm_host left.
struct Outcome {
    int exitCode{};
    std::string out, err;
    std::size_t errorLines() const {
        return static_cast<std::size_t>(std::count(err.begin(), err.end(), '\n'));
    }
};

// Each test has a folder of its own, where pm_host runs as a process of its own, with the variables
// that colour, textures and locales listen to cleared.
class HostProcess : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string name = ::testing::TempDir() + "pm_robust.XXXXXX";
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        m_folder = name;
        write("box.mtl", "newmtl light\nKd 0 0 0\nKe 5 5 5\nnewmtl wall\nKd 0.5 0.5 0.5\n");
        write("box.obj",
              "mtllib box.mtl\nv -1 0 0\nv 1 0 0\nv 1 2 0\nv -1 2 0\nv -1 0 2\nv 1 0 2\n"
              "v -0.5 2 0\nv 0.5 2 0\nv 0.5 2 1\nv -0.5 2 1\n"
              "usemtl wall\nf 1 2 3 4\nf 5 6 2 1\nusemtl light\nf 7 8 9 10\n");
    }
    void TearDown() override {
        std::error_code ignored;
        fs::remove_all(m_folder, ignored);
    }

    fs::path path(const std::string& name) const { return m_folder / name; }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(path(name), std::ios::binary) << text;
    }

    // Runs in the folder; while it runs, during is called with its process id. It is a fork of a
    // process that has loaded pm_host, or, where pm_host starts itself again or looks for its
    // library, the program.
    Outcome run(std::vector<std::string> arguments,
                const std::function<void(pid_t)>& during = nullptr,
                const std::vector<std::pair<std::string, std::string>>& variables = {}) const;
    // The program, for tests of how it begins.
    Outcome runProgram(std::vector<std::string> arguments,
                       const std::function<void(pid_t)>& during = nullptr) const;

    // A small render of the box that takes a moment.
    Outcome render(std::vector<std::string> more) const {
        std::vector<std::string> arguments{"box.obj",   "--size", "16x16", "--passes", "2",
                                           "--photons", "1000",   "--aa",  "2",        "-q"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run(arguments);
    }

    // Names in the folder, without what the tests put there.
    std::vector<std::string> leftFiles() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(m_folder)) {
            const std::string name = entry.path().filename().string();
            if (name != ".out" && name != ".err" && name != ".cache" && name != "box.obj" &&
                name != "box.mtl") {
                names.push_back(name);
            }
        }
        std::sort(names.begin(), names.end());
        return names;
    }

    // The run failed with this code, one line on standard error that has all parts, and no file.
    void expectRefusal(const Outcome& outcome, int code,
                       const std::vector<std::string>& parts) const {
        EXPECT_EQ(outcome.exitCode, code) << outcome.err;
        EXPECT_EQ(outcome.errorLines(), 1u) << outcome.err;
        EXPECT_TRUE(outcome.err.starts_with("pm_host: ")) << outcome.err;
        for (const std::string& part : parts) {
            EXPECT_NE(outcome.err.find(part), std::string::npos) << part << " in " << outcome.err;
        }
        EXPECT_EQ(outcome.out, "");
        EXPECT_FALSE(fs::exists(path("box.exr")));
        for (const std::string& name : leftFiles()) {
            EXPECT_EQ(name.find(".tmp"), std::string::npos) << name;
        }
    }

    // A folder for textures that the last run made for itself alone; empty when none is there.
    std::string textureFolder() const {
        const std::string start = "pm_host." + std::to_string(m_lastChild) + ".";
        for (const auto& entry : fs::directory_iterator(fs::temp_directory_path())) {
            const std::string name = entry.path().filename().string();
            if (name.starts_with(start)) return entry.path().string();
        }
        return {};
    }
    // Files in the folder of prepared textures that have no final name.
    std::vector<std::string> halfMadeTextures() const {
        std::vector<std::string> names;
        std::error_code none;
        for (const auto& entry :
             fs::directory_iterator(m_folder / ".cache" / "pm" / "textures", none)) {
            const std::string name = entry.path().filename().string();
            if (name.find("tmp") != std::string::npos) names.push_back(name);
        }
        return names;
    }

    // Gives the walls of the box a picture.
    void addTexture() const {
        DisplayPicture picture{4, 4, 3, std::vector<float>(48, 0.5f)};
        writeDisplayPicture(path("wall.png"), picture);
        write("box.mtl", "newmtl light\nKd 0 0 0\nKe 5 5 5\nnewmtl wall\nmap_Kd -s 2 2 wall.png\n");
    }

    fs::path m_folder;
    mutable pid_t m_lastChild{};

  private:
    Outcome end(const std::function<void(pid_t)>& during) const;
};

}  // namespace pm::host::test
