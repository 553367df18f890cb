// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Any single allocation may fail, ours or one of a library's below: the interface answers with a
// status and a text, nothing crashes, hangs or is lost. The suite takes some hundred of them;
// PM_ALLOC=all in the environment takes all, or 2000 of new processes (./dev test --alloc).
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <string_view>

#include "tests/abi/host.h"
#include "tests/alloc/allocation_walk.h"

namespace pm::test {

namespace {

class Allocation : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string name = ::testing::TempDir() + "pm_alloc.XXXXXX";
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        m_folder = name;
        std::ofstream(m_folder + "/four.ppm", std::ios::binary)
            << "P6\n2 2\n255\n"
            << std::string("\377\0\0\0\377\0\0\0\377\377\377\377", 12);
        std::ofstream(m_folder + "/text.ppm") << "no picture";
    }
    void TearDown() override {
        std::error_code ignored;
        std::filesystem::remove_all(m_folder, ignored);
    }

    // Of `count` allocations so many, as evenly as can be, the first and the last among them.
    static std::vector<std::uint64_t> spread(std::uint64_t count, std::uint64_t wanted) {
        std::vector<std::uint64_t> numbers;
        wanted = std::min(wanted, count);
        for (std::uint64_t i = 0; i < wanted; ++i)
            numbers.push_back(wanted == 1 ? 1 : 1 + i * (count - 1) / (wanted - 1));
        return numbers;
    }

    void expectSurvival(const Walk& walk, Start start, std::uint64_t wanted) {
        constexpr std::uint64_t kMostNewProcesses = 2000;
        if (const char* all = getenv("PM_ALLOC"); all != nullptr && std::strcmp(all, "all") == 0)
            wanted = start == Start::kWarm ? UINT64_MAX : kMostNewProcesses;
        const std::uint64_t count = countAllocations(api(), walk, m_folder.c_str(), start);
        const std::vector<std::uint64_t> numbers = spread(count, wanted);
        std::printf("%s, %s: %zu of %zu allocations\n", walk.name,
                    start == Start::kWarm ? "warm" : "cold", numbers.size(),
                    static_cast<std::size_t>(count));
        std::map<std::string, int> below;
        for (const Finding& found : walkFailing(api(), walk, m_folder.c_str(), start, numbers)) {
            if (isKnownBelow(found)) {
                ++below[found.what + " in " + found.below];
                continue;
            }
            ADD_FAILURE() << walk.name << ":" << found.number << ": " << found.what
                          << "\n  memory was refused at\n"
                          << found.failedStack << "  it crashed at\n"
                          << found.crashStack;
        }
        for (const auto& [what, count] : below) std::printf("    %d: %s\n", count, what.c_str());
    }

    // What libraries below make of it and pm can't help: docs/c_interface.md has the table.
    static bool isKnownBelow(const Finding& found) {
        constexpr std::array<std::string_view, 4> kLibraries = {"libembree3", "libOpenImageIO",
                                                                "libosdCPU", "libtbb"};
        const bool isFileError = found.what.starts_with("status -8");  // PMR_ERROR_IO
        return (!found.isStatus || isFileError) &&
               std::any_of(kLibraries.begin(), kLibraries.end(), [&](std::string_view library) {
                   return found.below.starts_with(library);
               });
    }

    std::string m_folder;
};

TEST_F(Allocation, MayFailInAProcessThatRendersBefore) {
    for (const Walk& walk : walks()) expectSurvival(walk, Start::kWarm, 80);
}

TEST_F(Allocation, MayFailInANewProcess) {
    for (const Walk& walk : walks()) expectSurvival(walk, Start::kCold, 20);
}

}  // namespace

}  // namespace pm::test
