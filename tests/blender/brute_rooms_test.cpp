// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Brute force itself beside Cycles, in rooms whose numbers brute_rooms.py has.
#include "tests/integrator/brute/brute_rooms.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "host_shim/pictures/picture_io.h"
#include "tests/integrator/brute/brute_force.h"

namespace pm::test {
namespace {

constexpr std::int32_t kWidth = 12, kHeight = 8;

// The mean of each channel over a rectangle.
std::array<double, 3> meanOf(const host::Picture& picture, const Rect& area) {
    std::array<double, 3> mean{};
    const char* const names[] = {"R", "G", "B"};
    for (std::size_t c = 0; c < 3; ++c) {
        const host::Channel* channel = picture.find(names[c]);
        for (std::int32_t y = area.y0; y < area.y1; ++y)
            for (std::int32_t x = area.x0; x < area.x1; ++x)
                mean[c] +=
                    static_cast<double>(channel->values[static_cast<std::size_t>(y * kWidth + x)]) /
                    static_cast<double>(area.area());
    }
    return mean;
}

// What differs most, over the Cycles picture, of halves and channels.
double largestDifference(const SceneMaker& maker, const host::Picture& cycles) {
    constexpr std::uint32_t kSamples = 1'000'000;
    const auto scene = maker.build();
    const BruteForce brute(*scene, kWidth, kHeight);
    double largest = 0;
    for (const Rect& area :
         {Rect{0, 0, 6, 4}, Rect{6, 0, 12, 4}, Rect{0, 4, 6, 8}, Rect{6, 4, 12, 8}}) {
        const auto mean = brute.mean(area, kSamples, 1), right = meanOf(cycles, area);
        for (std::size_t c = 0; c < 3; ++c) {
            const double difference = mean[c] / right[c] - 1;
            fmt::print("    {} {}, channel {}: {:+.4f}\n", area.x0, area.y0, c, difference);
            largest = std::max(largest, std::abs(difference));
        }
    }
    return largest;
}

TEST(BruteForceBesideCycles, FourRooms) {
    if (std::system("command -v blender > /dev/null") != 0)
        GTEST_SKIP() << "blender is not installed";
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / fmt::format("pm_brute_rooms.{}", getpid());
    std::filesystem::create_directories(folder);
    const std::string command = fmt::format(
        "blender -b --factory-startup -noaudio --python-exit-code 1 "
        "-P '{}/tests/blender/brute_rooms.py' -- '{}' 8192 > '{}/blender.log' 2>&1",
        PM_SOURCE_DIR, folder.string(), folder.string());
    ASSERT_EQ(std::system(command.c_str()), 0) << "see " << folder;
    const std::pair<const char*, SceneMaker> rooms[] = {
        {"smooth", withBalls(glass(), mirror())},
        {"rough", withBalls(rough(glass(), 0.2f), rough(glass(), 0.5f))},
        {"instances", mirrorsOfOneMesh()},
        {"sky", ballsUnderASky()}};
    for (const auto& [name, maker] : rooms) {
        const host::Picture cycles = host::readExr(folder / fmt::format("cycles_{}.exr", name));
        fmt::print("  {}\n", name);
        // Means of a quarter differ by .5 % from seed to seed. What glass of roughness .5 scatters
        // more than once Cycles 3.4 follows from facet to facet.
        const double allowed = std::string_view(name) == "rough" ? 0.03 : 0.022;
        EXPECT_LT(largestDifference(maker, cycles), allowed) << name;
    }
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace pm::test
