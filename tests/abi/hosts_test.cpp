// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Hosts in other languages, the exported symbols, loading and unloading.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

namespace {

struct Outcome {
    int status;
    std::vector<std::string> lines;
};

Outcome run(const std::string& command) {
    FILE* pipe = popen(command.c_str(), "r");
    if (pipe == nullptr) return {-1, {}};
    std::string text;
    std::array<char, 4096> buffer;
    while (const std::size_t count = fread(buffer.data(), 1, buffer.size(), pipe))
        text.append(buffer.data(), count);
    Outcome outcome{pclose(pipe), {}};
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) outcome.lines.push_back(line);
    return outcome;
}

TEST(Hosts, ExportsOneSymbol) {
    const Outcome outcome = run("nm -D --defined-only '" PM_PLUGIN_FILE "'");
    ASSERT_EQ(0, outcome.status);
    ASSERT_EQ(1u, outcome.lines.size()) << outcome.lines.back();
    EXPECT_NE(std::string::npos, outcome.lines[0].find(" T pmrGetApi"));
}

TEST(Hosts, CAndPythonRenderTheSameBits) {
    const Outcome inC = run("'" PM_BOX_HOST "' '" PM_PLUGIN_FILE "' 1");
    ASSERT_EQ(0, inC.status);
    ASSERT_EQ(1u, inC.lines.size());
    EXPECT_EQ(16u, inC.lines[0].size());
#ifdef PM_SANITIZED
    GTEST_SKIP() << "the library is built with sanitizers";
#endif
    // The distribution's own, where there is one: it is built as the library is.
    const std::string python =
        std::filesystem::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";
    if (run(python + " -c 'import ctypes' 2>/dev/null").status != 0)
        GTEST_SKIP() << "no Python with ctypes here";
    const Outcome inPython = run(python + " '" PM_BOX_HOST_PY "' '" PM_PLUGIN_FILE "'");
    ASSERT_EQ(0, inPython.status);
    EXPECT_EQ(inC.lines, inPython.lines);
}

TEST(Hosts, LoadsAndUnloadsTwentyTimes) {
    const Outcome outcome = run("'" PM_BOX_HOST "' '" PM_PLUGIN_FILE "' 20");
    ASSERT_EQ(0, outcome.status);
    ASSERT_EQ(20u, outcome.lines.size());
    for (const std::string& line : outcome.lines) EXPECT_EQ(outcome.lines[0], line);
}

}  // namespace
