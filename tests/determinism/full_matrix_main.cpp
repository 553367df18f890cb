// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The same bits for all combinations, with --quick some. A program of GoogleTest's, whose options
// it has, too: --only 7 --gtest_repeat=50.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <cstddef>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/bench/run/timing.h"
#include "tests/determinism/same_bits_matrix.h"

namespace pm::test {

namespace {

// Of the combinations; from 1.
struct Chosen {
    std::size_t share = 1, shares = 1;
    std::size_t only = 0;  // 0: all of the share
};

constexpr std::size_t kQuickShares = 97;  // a prime: every level of every factor is met
constexpr std::size_t kToldAfter = 100;
constexpr int kManyResumed = 20;

class FullMatrix : public ::testing::Test {
  public:
    explicit FullMatrix(const Chosen& chosen) : m_chosen(chosen) {}

    void TestBody() override {
        const std::size_t count = m_matrix.all().size();
        if (m_chosen.only > count) {
            FAIL() << fmt::format("--only {}: combinations are 1 to {}", m_chosen.only, count);
        }
        const std::vector<std::size_t> indices =
            m_chosen.only > 0 ? std::vector{m_chosen.only - 1}
                              : indicesOfShare(count, m_chosen.share, m_chosen.shares);
        for (const std::size_t index : indices) {
            if (!m_matrix.isPossible(m_matrix.all()[index])) continue;
            check(index);
            if (++m_ran % kToldAfter == 0) tell();
        }
        tell();
        if (m_ran < indices.size())
            std::cout << fmt::format(
                "{} left out: no locale with a comma is here, and none can be made\n",
                indices.size() - m_ran);
        tellInterruptions();
    }

  private:
    void check(std::size_t index) {
        const Way way = m_matrix.wayOf(m_matrix.all()[index]);
        m_resumed += way.resumeThreads > 0 ? 1 : 0;
        // Also where the picture can't be made.
        SCOPED_TRACE(fmt::format("combination {}: {}\nto repeat: ./dev bench same_bits --only {}",
                                 index + 1, way.text(), index + 1));
        const std::string found = m_studios[isOneBucket(way) ? 1 : 0].differenceOf(way);
        EXPECT_EQ("", found);
        m_differ += found.empty() ? 0 : 1;
    }

    void tellInterruptions() const {
        Interruptions all;
        for (const SameBitsStudio& studio : m_studios) {
            all.withinAPass += studio.interruptions().withinAPass;
            all.betweenPasses += studio.interruptions().betweenPasses;
            all.tooLate += studio.interruptions().tooLate;
        }
        std::cout << fmt::format("resumed within a pass {}, between passes {}, at the end {}\n",
                                 all.withinAPass, all.betweenPasses, all.tooLate);
        EXPECT_EQ(all.withinAPass + all.betweenPasses + all.tooLate, m_resumed);
        // Where a cancel falls is a matter of time.
        if (m_resumed >= kManyResumed) {
            EXPECT_GT(all.withinAPass, all.tooLate);
        }
    }

    void tell() const {
        std::cout << fmt::format(
                         "{} of {} combinations, {} differ; share {} of {}; {:.1f} "
                         "processor seconds\n",
                         m_ran, m_matrix.all().size(), m_differ, m_chosen.share, m_chosen.shares,
                         bench::processorSeconds())
                  << std::flush;
    }

    Chosen m_chosen;
    SameBitsMatrix m_matrix;
    // By isOneBucket().
    std::array<SameBitsStudio, 2> m_studios{
        {SameBitsStudio{fullMatrixSettings(false)}, SameBitsStudio{fullMatrixSettings(true)}}};
    std::size_t m_ran = 0, m_differ = 0;
    int m_resumed = 0;
};

// "I/N", 1 <= I <= N.
bool readShare(std::string_view text, Chosen& chosen) {
    const char* const end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, chosen.share);
    if (first.ec != std::errc() || first.ptr == end || *first.ptr != '/') return false;
    const auto second = std::from_chars(first.ptr + 1, end, chosen.shares);
    return second.ec == std::errc() && second.ptr == end && chosen.share >= 1 &&
           chosen.share <= chosen.shares;
}

int runProgram(int argc, char** argv) {
    ::testing::InitGoogleTest(&argc, argv);
    Chosen chosen;
    std::string share, docsFile;
    bool isQuick = false;
    CLI::App app("The same bits, whatever a host may choose: all combinations");
    app.add_option("--share", share, "I/N, the I-th of N shares (1/1)");
    app.add_option("--only", chosen.only, "this one, by its number from 1")
        ->check(CLI::Range(1, 1'000'000));
    app.add_flag("--quick", isQuick, fmt::format("share 1/{}", kQuickShares));
    app.add_option("--docs", docsFile, "not looked at: nothing is measured");
    CLI11_PARSE(app, argc, argv);
    if (isQuick) chosen.shares = kQuickShares;
    if (!share.empty() && !readShare(share, chosen)) {
        std::cerr << "pm_bench_same_bits: --share " << share << ": I/N, 1 <= I <= N\n";
        return 2;
    }
    ::testing::RegisterTest("SameBits", "FullMatrix", nullptr, nullptr, __FILE__, __LINE__,
                            [chosen]() -> ::testing::Test* { return new FullMatrix(chosen); });
    return RUN_ALL_TESTS();
}

}  // namespace

}  // namespace pm::test

int main(int argc, char** argv) {
    return pm::test::runProgram(argc, argv);
}
