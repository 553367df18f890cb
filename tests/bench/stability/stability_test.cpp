// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The sweeps of docs/stability.md at three values each: both ends and the middle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "integrator/scene/scene.h"
#include "tests/bench/stability/sweep.h"
#include "tests/bench/stability/sweep_page.h"
#include "tests/support/rooms.h"

namespace pm::bench {

// For the names of tests that fail.
void PrintTo(const Sweep& sweep, std::ostream* out);
void PrintTo(const Sweep& sweep, std::ostream* out) {
    *out << sweep.kind << ", " << sweep.name << " " << sweep.variant;
}

namespace {

std::vector<Sweep> shortSweeps() {
    std::vector<Sweep> sweeps;
    for (const Sweep& sweep : allSweeps())
        if (!sweep.isLong) sweeps.push_back(shortened(sweep));
    return sweeps;
}

// Of all sweeps together once in a hundred times by chance.
double limit() {
    std::size_t count = 0;
    for (const Sweep& sweep : shortSweeps()) count += sweep.values.size();
    return limitOfChance(count);
}

class Stability : public ::testing::TestWithParam<Sweep> {};

TEST_P(Stability, IsFlat) {
    const SweepResult result = run(GetParam(), 4);
    EXPECT_TRUE(result.isFlat(limit())) << outcomeLine(result, limit());
}

INSTANTIATE_TEST_SUITE_P(Sweeps, Stability, ::testing::ValuesIn(shortSweeps()),
                         [](const auto& info) {
                             const Sweep& sweep = info.param;
                             std::string name = sweep.kind + "_" + sweep.name + "_" + sweep.variant;
                             for (char& c : name)
                                 if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
                             return name;
                         });

// Beyond the limit of what rays tell apart a scene is warned of, and not before.
bool isWarnedOf(const test::SceneMaker& maker) {
    return std::ranges::any_of(maker.build()->notices(), [](const Notice& notice) {
        return notice.code == NoticeCode::kDegenerateGeometry;
    });
}

TEST(StabilityLimit, GlassCloserThanRaysCanTellIsWarnedOf) {
    const auto spheres = [](double gap) {
        test::SceneMaker maker;
        maker.sphere({}, 1, maker.material(test::glass()));
        maker.sphere({}, 1 - gap, maker.material(test::air()));
        return maker;
    };
    const auto blocks = [](double gap) {
        test::SceneMaker maker;
        maker.box(Vec3d(-0.5), Vec3d(0.5), maker.material(test::glass()), false);
        maker.box(Vec3d(-0.5 + gap), Vec3d(0.5 - gap), maker.material(test::glass(1.33f)), false);
        return maker;
    };
    EXPECT_TRUE(isWarnedOf(spheres(1e-7)));
    EXPECT_TRUE(isWarnedOf(blocks(1e-7)));
    for (const double gap : {0.1, 1e-3, 1e-5, 1e-6}) {
        EXPECT_FALSE(isWarnedOf(spheres(gap))) << gap;
        EXPECT_FALSE(isWarnedOf(blocks(gap))) << gap;
    }
}

// The harness itself: what drifts is found, noise alone is not.
TEST(SweepHarness, FindsADrift) {
    Sweep sweep{.kind = "", .name = "", .values = decades(0, 4)};
    sweep.expected = [](double, std::uint64_t) { return 1.0; };
    const auto noise = [](std::uint64_t seed) {
        return 1e-3 * (static_cast<double>(seed * 2654435761 % 1000) / 1000 - 0.5);
    };
    sweep.measure = [=](double, std::uint64_t seed) { return 1 + noise(seed); };
    EXPECT_TRUE(run(sweep, 8).isFlat(limitOfChance(5)));
    sweep.measure = [=](double value, std::uint64_t seed) {
        return 1 + noise(seed) + 1e-6 * value;
    };
    EXPECT_FALSE(run(sweep, 8).isFlat(limitOfChance(5)));
    EXPECT_EQ(run(sweep, 8).worst().value, 1e4);
    sweep.flatTo = 10;
    EXPECT_TRUE(run(sweep, 8).isFlat(limitOfChance(5)));
    EXPECT_EQ(shortened(sweep).values.size(), 2u);
}

TEST(SweepHarness, RefusesWhatIsNoNumberAndAnyFault) {
    Sweep sweep{.kind = "", .name = "", .values = {1}};
    sweep.isCount = true;
    sweep.measure = [](double, std::uint64_t) { return 1.0; };
    EXPECT_FALSE(run(sweep, 2).isFlat(5));
    sweep.measure = [](double, std::uint64_t) { return std::nan(""); };
    EXPECT_FALSE(run(sweep, 2).isFlat(5));
    sweep.measure = [](double, std::uint64_t) { return 0.0; };
    EXPECT_TRUE(run(sweep, 2).isFlat(5));
}

TEST(SweepPage, HasThePlotsThePointsAndTheLimits) {
    Sweep sweep{.kind = "kind", .name = "a name", .values = decades(0, 4)};
    sweep.flatTo = 100;
    sweep.limit = "why it ends.";
    sweep.expected = [](double, std::uint64_t) { return 1.0; };
    sweep.measure = [](double value, std::uint64_t) { return value > 100 ? 2.0 : 1.0; };
    const auto folder = std::filesystem::path(::testing::TempDir()) / "sweep_page";
    std::filesystem::create_directories(folder);
    const SweepResult result = run(sweep, 2);
    writeSweepPage(folder / "page.md", {&result, 1});
    EXPECT_TRUE(std::filesystem::exists(folder / "images/page/kind_a-name.svg"));
    EXPECT_TRUE(std::filesystem::exists(folder / "lab/page.csv"));
    std::ifstream page(folder / "page.md");
    const std::string text{std::istreambuf_iterator<char>(page), {}};
    EXPECT_NE(text.find("images/page/kind_a-name.svg"), std::string::npos);
    EXPECT_NE(text.find("Why it ends. Flat: 1 to 100."), std::string::npos) << text;
}

}  // namespace
}  // namespace pm::bench
